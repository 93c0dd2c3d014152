"""A vehicle made with pymavlink, which is independent of flagred, to test that both understand each other.

Usage: pymavlink_peer.py FLAGRED [1|2|signed]

Starts `FLAGRED watch` on a free port, flies a generated flight whose motors saturate, in MAVLink 1 or 2, and checks the
answers. In MAVLink 2 it sends signed packets at the end, which must be skipped with a note. In the signed round, both
have a key: pymavlink signs and verifies all packets, and its unsigned or replayed packets at the end must be refused.
"""

import atexit
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time

flagred, version = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "2"
is_signed = version == "signed"
if version != "1":
    os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "ardupilotmega"
from pymavlink import mavutil  # noqa: E402  the version is chosen by the environment

PARAMETERS = {f"SERVO{n}_FUNCTION": 0 for n in range(1, 17)}
PARAMETERS |= {f"SERVO{n}_FUNCTION": 32 + n for n in range(1, 5)}
PARAMETERS |= {"MOT_PWM_MIN": 1000, "MOT_PWM_MAX": 2000, "MOT_SPIN_MIN": 0.15, "MOT_SPIN_MAX": 0.95}
PARAMETERS |= {"FRAME_CLASS": 1, "FRAME_TYPE": 1}

KEY = bytes(range(32))
key_file = tempfile.NamedTemporaryFile()
key_file.write(KEY)
key_file.flush()
options = ["--key", key_file.name] if is_signed else []
watch = subprocess.Popen(
    [flagred, "watch", "udpin:127.0.0.1:0", "--jsonl", *options], stdout=subprocess.PIPE, text=True
)
atexit.register(watch.kill)  # a remaining watch would keep the pipes of the caller open
started = json.loads(watch.stdout.readline())
address = started["endpoint"].removeprefix("listening at ")
link = mavutil.mavlink_connection(f"udpout:{address}", source_system=3, source_component=1)
mavlink = mavutil.mavlink
if is_signed:
    link.setup_signing(KEY, sign_outgoing=True)
heard = []
asked = set()


def beat(armed, in_air):
    link.mav.heartbeat_send(
        mavlink.MAV_TYPE_QUADROTOR,
        mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
        mavlink.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0,
        0,
        mavlink.MAV_STATE_ACTIVE if in_air else mavlink.MAV_STATE_STANDBY,
    )


def listen():
    while (message := link.recv_msg()) is not None:
        heard.append(message)
        kind = message.get_type()
        if kind == "PARAM_REQUEST_READ":
            asked.add(message.param_id)
            value = PARAMETERS[message.param_id]
            name = message.param_id.encode()
            link.mav.param_value_send(name, value, mavlink.MAV_PARAM_TYPE_REAL32, len(PARAMETERS), 65535)
        elif kind == "COMMAND_LONG":
            link.mav.command_ack_send(message.command, mavlink.MAV_RESULT_ACCEPTED)


def pulses(t_s):
    """20 s of hovering, 15 s of motors that alternate between their limits, and hovering again."""
    if 20 <= t_s < 35:
        return [1000 + 975 * (round(t_s * 25) // 5 + n & 1) for n in range(4)]
    return [round(1500 + 10 * math.sin(3 * t_s + n)) for n in range(4)]


def asked_rates():
    """The requested interval of each message, in microseconds."""
    return {int(m.param1): m.param2 for m in heard if m.get_type() == "COMMAND_LONG"}


deadline = time.monotonic() + 10
while not (asked == set(PARAMETERS) and asked_rates()) and time.monotonic() < deadline:
    beat(False, False)
    time.sleep(0.02)
    listen()

for i in range(25 * 60):
    t_s = i / 25
    if i % 5 == 0:
        beat(True, 1 <= t_s < 59)
    link.mav.servo_output_raw_send(round(t_s * 1e6), 0, *pulses(t_s), 0, 0, 0, 0)
    time.sleep(0.001)
    listen()
for _ in range(120):
    beat(False, False)
    time.sleep(0.01)
    listen()
if version == "2":
    link.setup_signing(b"k" * 32, sign_outgoing=True)
    for _ in range(5):
        beat(True, True)
    time.sleep(0.2)

if is_signed:
    replay = link.mav.heartbeat_encode(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 128, 0, 4)
    replay = replay.pack(link.mav)
    for _ in range(4):  # the first is genuine
        link.write(replay)
    link.mav.signing.sign_outgoing = False
    for _ in range(5):
        beat(True, True)
    time.sleep(0.2)

watch.send_signal(signal.SIGINT)
events = [json.loads(line) for line in watch.stdout]
code = watch.wait()


def expect(true, what):
    if not true:
        sys.exit(f"MAVLink {version}: {what}\nheard: {[str(m) for m in heard][-20:]}\nsaid: {events[-3:]}")


expect(asked == set(PARAMETERS), f"asked for {sorted(asked)}")
of = lambda kind: [m for m in heard if m.get_type() == kind]
expect(not of("BAD_DATA"), "packets that pymavlink cannot read")
expect(
    {(m.get_srcSystem(), m.get_srcComponent()) for m in heard if m.get_srcSystem() != 255} == {(3, 191)},
    "the sender is not component 191 of the vehicle",
)
expect(
    of("HEARTBEAT")
    and all(
        (m.type, m.autopilot) == (mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID)
        for m in of("HEARTBEAT")
    ),
    "no heartbeat of an onboard controller",
)
rate = asked_rates().get(mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW)
expect(rate == 40000, f"asked for rates {asked_rates()}")
for name in ["FR_RISK", "FR_ELEV"]:
    values = [m.value for m in of("NAMED_VALUE_FLOAT") if m.name == name]
    expect(len(values) >= 2 and all(0 <= v <= 100 for v in values), f"{name}: {values}")
texts = [(m.severity, m.text) for m in of("STATUSTEXT")]
levels = [e["text"] for e in events if e["event"] == "level"]
expect([text for _, text in texts] == levels, f"texts {texts}, levels {levels}")
expect(any(s == mavlink.MAV_SEVERITY_CRITICAL and t.startswith("FLAGRED: FAIL") for s, t in texts), f"texts {texts}")
landed = [e["verdict"] for e in events if e["event"] == "landed"]
expect(landed == ["FAIL"], f"verdicts {landed}")
signed = events[-1]["signed"]
notes = [e["text"] for e in events if e["event"] == "note"]
if version == "2":
    expect(signed == 5 and any("signed" in note for note in notes), f"{signed} signed, notes {notes}")
    expect(not [e for e in events if e["event"] == "took_off"][1:], "a signed heartbeat was believed")
if is_signed:
    signing = link.mav.signing
    expect(signing.goodsig_count == len(heard) and signing.badsig_count == 0, f"signatures: {vars(signing)}")
    refused = events[-1]["unsigned"], events[-1]["bad_signatures"], signed
    expect(refused == (5, 3, 0), f"refused: {refused}")
    expect(not [e for e in events if e["event"] == "took_off"][1:], "an unsigned heartbeat was believed")
expect(events[-1]["bad_checksums"] == 0, "packets were not understood")
expect(code == 1, f"exit code {code}")
print(f"MAVLink {version}: {len(heard)} messages understood, {len(texts)} texts, {len(levels)} changes of level")
