"""A stand-in for ArduCopter's simulator, for scripts/try-against-sitl: two TCP links that forward to each other, the
commands of the script, and motors that hover, turn and lose thrust. It does not simulate flight dynamics.

Usage: sitl_stand_in.py SPEED. Prints the ports of its links.
"""

import math
import os
import select
import socket
import sys
import time

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "ardupilotmega"
from pymavlink.dialects.v20 import ardupilotmega as mavlink  # noqa: E402  the version is chosen by the environment

speed = float(sys.argv[1])
PARAMETERS = {f"SERVO{n}_FUNCTION": 0 for n in range(1, 33)}
PARAMETERS |= {f"SERVO{n}_FUNCTION": 32 + n for n in range(1, 5)}
PARAMETERS |= {"MOT_PWM_MIN": 1000, "MOT_PWM_MAX": 2000, "MOT_SPIN_MIN": 0.15, "MOT_SPIN_MAX": 0.95}
PARAMETERS |= {"FRAME_CLASS": 1, "FRAME_TYPE": 1, "SIM_ENGINE_FAIL": 0, "SIM_ENGINE_MUL": 1}


class Link:
    def __init__(self):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.client = None
        self.mav = mavlink.MAVLink(self, srcSystem=1, srcComponent=1)
        self.mav.robust_parsing = True

    def write(self, data):
        if self.client:
            try:
                self.client.sendall(data)
            except OSError:
                self.client = None

    def read(self):
        if select.select([self.server], [], [], 0)[0]:
            self.client = self.server.accept()[0]
        if not self.client or not select.select([self.client], [], [], 0)[0]:
            return []
        try:
            data = self.client.recv(65536)
        except OSError:
            data = b""
        if not data:
            self.client = None
            return []
        return self.mav.parse_buffer(data) or []


links = [Link(), Link()]
print(*(link.server.getsockname()[1] for link in links), flush=True)
start = time.monotonic()
is_armed = is_in_air = False
turn_until = landing_at = weak_since = -1.0
every = {}  # the interval of each message, in seconds
due = {}


def now():
    return (time.monotonic() - start) * speed


def send(name, *values):
    for link in links:
        getattr(link.mav, name + "_send")(*values)


def command(message):
    global is_armed, is_in_air, turn_until, landing_at
    number, values = message.command, [message.param1, message.param2]
    if number == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
        is_armed = values[0] == 1
    elif number == mavlink.MAV_CMD_NAV_TAKEOFF:
        is_in_air = is_armed
    elif number == mavlink.MAV_CMD_CONDITION_YAW:
        turn_until = now() + values[0] / values[1]
    elif number == mavlink.MAV_CMD_DO_SET_MODE and values[1] == 9:
        landing_at = now() + 10
    elif number == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
        every[int(values[0])] = values[1] * 1e-6
    send("command_ack", number, mavlink.MAV_RESULT_ACCEPTED)


def take(message):
    global weak_since
    kind = message.get_type()
    if kind == "COMMAND_LONG":
        command(message)
    elif kind in ("PARAM_REQUEST_READ", "PARAM_SET"):
        name = message.param_id
        if kind == "PARAM_SET":
            PARAMETERS[name] = message.param_value
            is_weak = PARAMETERS["SIM_ENGINE_FAIL"] and PARAMETERS["SIM_ENGINE_MUL"] < 1
            weak_since = now() if is_weak else -1.0
        if name in PARAMETERS:
            send("param_value", name.encode(), PARAMETERS[name], mavlink.MAV_PARAM_TYPE_REAL32, 900, 65535)


def pulses(t_s):
    if not is_in_air:
        return [1100 if is_armed else 1000] * 4
    turn = 60 if t_s < turn_until else 0
    motors = [1500 + turn * (1 if n < 2 else -1) + 3 * math.sin(2 * t_s + n) for n in range(4)]
    if weak_since >= 0:
        shake = 250 * math.sin(6 * t_s) if t_s < weak_since + 8 else 0
        motors[0] += 180 + shake
        motors[1] -= 120 + shake
    return [round(min(2000, max(1000, motor))) for motor in motors]


def is_due(message, seconds):
    if now() < due.get(message, 0):
        return False
    due[message] = now() + every.get(message, seconds)
    return True


while True:
    for here, there in (links, links[::-1]):
        for message in here.read():
            there.write(message.get_msgbuf())
            if message.get_type() != "BAD_DATA":
                take(message)
    t_s = now()
    if 0 <= landing_at <= t_s:
        is_in_air, is_armed, landing_at = False, False, -1.0
    if is_due(mavlink.MAVLINK_MSG_ID_HEARTBEAT, 1):
        flags = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if is_armed else 0)
        state = mavlink.MAV_STATE_ACTIVE if is_in_air else mavlink.MAV_STATE_STANDBY
        send("heartbeat", mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, flags, 4, state)
    if is_due(mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 0.25):
        state = mavlink.MAV_LANDED_STATE_IN_AIR if is_in_air else mavlink.MAV_LANDED_STATE_ON_GROUND
        send("extended_sys_state", 0, state)
    if is_due(mavlink.MAVLINK_MSG_ID_ATTITUDE, 0.25):
        send("attitude", round(t_s * 1e3), 0, 0, 0, 0, 0, 0)
    if is_due(mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, 1):
        send("servo_output_raw", round(t_s * 1e6), 0, *pulses(t_s), *[0] * 12)
    time.sleep(0.002)
