// Runs the example: calm motors, then motors alternately at their limits, 50 times a second.
#include <cmath>
#include <stub.hpp>

orb_metadata topic_actuator_motors, topic_vehicle_land_detected, topic_debug_key_value;
px4::WorkItem *registered;
std::map<std::string, double> parameters;

extern "C" int flagred_monitor_main(int argc, char *argv[]);

int main() {
    const double places[4][3] = {{0.2, 0.2, 0.05}, {-0.2, -0.2, 0.05}, {0.2, -0.2, -0.05}, {-0.2, 0.2, -0.05}};
    char name[] = "flagred_monitor", start[] = "start";
    char *arguments[] = {name, start};
    if (flagred_monitor_main(2, arguments) == PX4_OK) {
        return 1; // without rotors
    }
    parameters["CA_ROTOR_COUNT"] = 4;
    for (int i = 0; i < 4; i++) {
        const char *const axes[3] = {"PX", "PY", "KM"};
        for (int axis = 0; axis < 3; axis++) {
            parameters["CA_ROTOR" + std::to_string(i) + "_" + axes[axis]] = places[i][axis];
        }
    }
    if (flagred_monitor_main(2, arguments) != PX4_OK || !registered) {
        return 2;
    }
    vehicle_land_detected_s land{0, false};
    topic_vehicle_land_detected.latest = &land;
    topic_vehicle_land_detected.updated = true;
    for (int i = 0; i < 2000; i++) {
        actuator_motors_s motors{};
        motors.timestamp = motors.timestamp_sample = static_cast<uint64_t>(i) * 20000;
        const float high = i % 40 < 20 ? 1.0f : 0.0f;
        for (int m = 0; m < 4; m++) {
            motors.control[m] = i < 1500 ? 0.5f : (m % 2 ? high : 1 - high);
        }
        topic_actuator_motors.latest = &motors;
        topic_actuator_motors.updated = true;
        registered->Run();
    }
    return 0;
}
