/* A PX4 module that reports how close a multirotor is to losing control: FR_RISK and FR_ELEV as debug_key_value,
 * which PX4 streams as NAMED_VALUE_FLOAT, and a text when the level changes. See docs/firmware.md. */
#include <cmath>
#include <cstdio>
#include <cstring>

#include <drivers/drv_hrt.h>
#include <parameters/param.h>
#include <px4_platform_common/module.h>
#include <px4_platform_common/px4_work_queue/WorkItem.hpp>
#include <systemlib/mavlink_log.h>
#include <uORB/Publication.hpp>
#include <uORB/Subscription.hpp>
#include <uORB/SubscriptionCallback.hpp>
#include <uORB/topics/actuator_motors.h>
#include <uORB/topics/debug_key_value.h>
#include <uORB/topics/vehicle_land_detected.h>

#include "profile.hpp"

class FlagredMonitor : public ModuleBase<FlagredMonitor>, public px4::WorkItem {
public:
    FlagredMonitor() : WorkItem("flagred_monitor", px4::wq_configurations::lp_default) {}

    static int task_spawn(int argc, char *argv[]);
    static int custom_command(int argc, char *argv[]) { return print_usage("unknown command"); }
    static int print_usage(const char *reason = nullptr);

    bool init();

private:
    /* 50 samples a second are enough; actuator_motors is published at the rate of the rate controller. */
    static constexpr uint32_t INTERVAL_US = 20000;
    static constexpr hrt_abstime SEND_US = 500000;
    static constexpr size_t MOST_MOTORS = FLAGRED_PROFILE_MOTORS;

    void Run() override;
    size_t geometry(flagred_factors factors[MOST_MOTORS]) const;
    void send(hrt_abstime now, const flagred_update &update);
    void say(const flagred_update &update);

    uORB::SubscriptionCallbackWorkItem _motors_sub{this, ORB_ID(actuator_motors)};
    uORB::Subscription _landed_sub{ORB_ID(vehicle_land_detected)};
    uORB::Publication<debug_key_value_s> _value_pub{ORB_ID(debug_key_value)};
    orb_advert_t _mavlink_log_pub{nullptr};

    flagred_monitor *_monitor{nullptr};
    size_t _motors{0};
    bool _landed{true};
    hrt_abstime _sent{0};
};

/* A parameter as a number; NAN if it does not exist. */
static double parameter(const char *name) {
    const param_t handle = param_find(name);
    float value = NAN;
    int32_t whole = 0;
    if (handle == PARAM_INVALID) {
        return NAN;
    }
    if (param_type(handle) == PARAM_TYPE_INT32) {
        return param_get(handle, &whole) == 0 ? whole : NAN;
    }
    return param_get(handle, &value) == 0 ? static_cast<double>(value) : NAN;
}

/* The factors of the motors from CA_ROTORn_PX, PY and KM, for propellers that point upwards. Returns their number; 0
 * if they are unknown. */
size_t FlagredMonitor::geometry(flagred_factors factors[MOST_MOTORS]) const {
    const double count = parameter("CA_ROTOR_COUNT");
    if (!(count >= 1 && count <= MOST_MOTORS)) {
        return 0;
    }
    const size_t motors = static_cast<size_t>(count);
    double most[3] = {};
    for (size_t i = 0; i < motors; i++) {
        const char *const names[3] = {"PY", "PX", "KM"};
        double parts[3];
        for (int axis = 0; axis < 3; axis++) {
            char name[24];
            snprintf(name, sizeof(name), "CA_ROTOR%u_%s", static_cast<unsigned>(i), names[axis]);
            parts[axis] = parameter(name);
            most[axis] = std::fmax(most[axis], std::fabs(parts[axis]));
        }
        factors[i] = {-parts[0], parts[1], parts[2]};
    }
    for (size_t i = 0; i < motors; i++) {
        factors[i].roll /= most[0] > 0 ? most[0] : 1;
        factors[i].pitch /= most[1] > 0 ? most[1] : 1;
        factors[i].yaw /= most[2] > 0 ? most[2] : 1;
    }
    return motors;
}

bool FlagredMonitor::init() {
    flagred_factors factors[MOST_MOTORS];
    _motors = geometry(factors);
    flagred_limits limits[MOST_MOTORS];
    for (flagred_limits &limit : limits) {
        limit = {0.0, 1.0}; /* actuator_motors is a fraction */
    }
    if (_motors == 0 || flagred_start(flagred_profile(), _motors, limits, flagred_profile_memory(), FLAGRED_PROFILE_MEMORY, &_monitor) != FLAGRED_OK) {
        PX4_ERR("no motors");
        return false;
    }
    if (flagred_set_geometry(_monitor, factors, _motors) != FLAGRED_OK) {
        PX4_WARN("geometry unknown: turns add to the risk");
    }
    _motors_sub.set_interval_us(INTERVAL_US);
    return _motors_sub.registerCallback();
}

void FlagredMonitor::Run() {
    if (should_exit()) {
        _motors_sub.unregisterCallback();
        exit_and_cleanup();
        return;
    }
    vehicle_land_detected_s land;
    if (_landed_sub.update(&land)) {
        _landed = land.landed;
    }
    actuator_motors_s motors;
    if (!_motors_sub.update(&motors)) {
        return;
    }
    double commands[MOST_MOTORS];
    for (size_t i = 0; i < _motors; i++) {
        /* NAN means that the motor is commanded to stop. */
        commands[i] = std::isfinite(motors.control[i]) ? static_cast<double>(motors.control[i]) : 0.0;
    }
    flagred_sample sample{};
    sample.t_s = static_cast<double>(motors.timestamp_sample) * 1e-6;
    sample.commands = commands;
    sample.motors = _motors;
    sample.in_air = _landed ? 0 : 1;
    flagred_update update;
    if (flagred_push(_monitor, &sample, &update) != FLAGRED_OK) {
        return;
    }
    if (!_landed && update.change != FLAGRED_LEVEL_NONE) {
        say(update);
    }
    if (std::isfinite(update.risk_pct) && motors.timestamp - _sent >= SEND_US) {
        _sent = motors.timestamp;
        send(motors.timestamp, update);
    }
}

void FlagredMonitor::send(hrt_abstime now, const flagred_update &update) {
    const struct {
        const char *name;
        double value;
    } values[] = {{"FR_RISK", update.risk_pct}, {"FR_ELEV", update.elevated_risk_pct}};
    for (const auto &value : values) {
        debug_key_value_s message{};
        message.timestamp = now;
        strncpy(message.key, value.name, sizeof(message.key) - 1);
        message.value = static_cast<float>(value.value);
        _value_pub.publish(message);
    }
}

void FlagredMonitor::say(const flagred_update &update) {
    flagred_finding finding;
    flagred_open_finding(_monitor, &finding);
    /* An alarm about a motor or the reserve has no cause of a risk. */
    const bool has_cause = finding.level != FLAGRED_LEVEL_NONE && finding.cause >= 0;
    const char *comma = has_cause ? ", " : "";
    const char *cause = has_cause ? flagred_profile_words(&finding)->brief : "";
    switch (update.change) {
    case FLAGRED_FAIL:
        mavlink_log_critical(&_mavlink_log_pub, "FLAGRED: FAIL risk %.0f %%%s%s\t", update.risk_pct, comma, cause);
        break;

    case FLAGRED_WARN:
        mavlink_log_warning(&_mavlink_log_pub, "FLAGRED: WARN risk %.0f %%%s%s\t", update.risk_pct, comma, cause);
        break;

    default:
        mavlink_log_info(&_mavlink_log_pub, "FLAGRED: GOOD\t");
    }
}

int FlagredMonitor::task_spawn(int argc, char *argv[]) {
    FlagredMonitor *instance = new FlagredMonitor();
    if (instance == nullptr) {
        return PX4_ERROR;
    }
    _object.store(instance);
    _task_id = task_id_is_work_queue;
    if (instance->init()) {
        return PX4_OK;
    }
    delete instance;
    _object.store(nullptr);
    _task_id = -1;
    return PX4_ERROR;
}

int FlagredMonitor::print_usage(const char *reason) {
    if (reason) {
        PX4_WARN("%s", reason);
    }
    PRINT_MODULE_USAGE_NAME("flagred_monitor", "system");
    PRINT_MODULE_USAGE_COMMAND("start");
    PRINT_MODULE_USAGE_DEFAULT_COMMANDS();
    return 0;
}

extern "C" __EXPORT int flagred_monitor_main(int argc, char *argv[]) {
    return FlagredMonitor::main(argc, argv);
}
