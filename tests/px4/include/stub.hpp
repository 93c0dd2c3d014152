// The parts of PX4 that the example uses: topics keep their latest message, and the test runs callbacks.
#pragma once

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>

#define __EXPORT
#define PX4_OK 0
#define PX4_ERROR (-1)
#define PX4_ERR(...) (fprintf(stderr, __VA_ARGS__), fputc('\n', stderr))
#define PX4_WARN(...) (fprintf(stderr, __VA_ARGS__), fputc('\n', stderr))
#define PRINT_MODULE_USAGE_NAME(name, category) ((void)0)
#define PRINT_MODULE_USAGE_COMMAND(command) ((void)0)
#define PRINT_MODULE_USAGE_DEFAULT_COMMANDS() ((void)0)

typedef uint64_t hrt_abstime;

struct orb_metadata {
    std::string name;
    const void *latest = nullptr;
    bool updated = false;
};
typedef void *orb_advert_t;
#define ORB_ID(topic) (&topic_##topic)

struct actuator_motors_s {
    uint64_t timestamp, timestamp_sample;
    float control[12];
};
struct vehicle_land_detected_s {
    uint64_t timestamp;
    bool landed;
};
struct debug_key_value_s {
    uint64_t timestamp;
    float value;
    char key[10];
};
extern orb_metadata topic_actuator_motors, topic_vehicle_land_detected, topic_debug_key_value;

namespace px4 {
struct wq_config_t {};
namespace wq_configurations {
static const wq_config_t lp_default;
}
class WorkItem {
public:
    WorkItem(const char *, const wq_config_t &) {}
    virtual ~WorkItem() = default;
    virtual void Run() = 0;
};
}

extern px4::WorkItem *registered;

namespace uORB {
class Subscription {
public:
    explicit Subscription(orb_metadata *topic) : _topic(topic) {}
    template <typename T> bool update(T *message) {
        if (!_topic->updated) {
            return false;
        }
        _topic->updated = false;
        *message = *static_cast<const T *>(_topic->latest);
        return true;
    }

private:
    orb_metadata *_topic;
};
class SubscriptionCallbackWorkItem : public Subscription {
public:
    SubscriptionCallbackWorkItem(px4::WorkItem *item, orb_metadata *topic) : Subscription(topic), _item(item) {}
    void set_interval_us(uint32_t) {}
    bool registerCallback() {
        registered = _item;
        return true;
    }
    void unregisterCallback() { registered = nullptr; }

private:
    px4::WorkItem *_item;
};
template <typename T> class Publication {
public:
    explicit Publication(orb_metadata *) {}
    bool publish(const T &message) {
        printf("%s %.4f\n", message.key, static_cast<double>(message.value));
        return true;
    }
};
}

template <typename T> class Holder {
public:
    void store(T *object) { _object = object; }

private:
    T *_object = nullptr;
};
static constexpr int task_id_is_work_queue = -2;

template <typename T> class ModuleBase {
public:
    static int main(int argc, char *argv[]) {
        return argc > 1 && std::string(argv[1]) == "start" ? T::task_spawn(argc, argv) : T::print_usage();
    }
    bool should_exit() const { return false; }
    void exit_and_cleanup() {}

protected:
    static inline Holder<T> _object;
    static inline int _task_id = -1;
};

typedef const char *param_t;
#define PARAM_INVALID nullptr
#define PARAM_TYPE_INT32 1
#define PARAM_TYPE_FLOAT 2
extern std::map<std::string, double> parameters;
inline param_t param_find(const char *name) {
    auto found = parameters.find(name);
    return found == parameters.end() ? nullptr : found->first.c_str();
}
inline int param_type(param_t name) { return name == std::string("CA_ROTOR_COUNT") ? PARAM_TYPE_INT32 : PARAM_TYPE_FLOAT; }
inline int param_get(param_t name, void *value) {
    if (param_type(name) == PARAM_TYPE_INT32) {
        *static_cast<int32_t *>(value) = static_cast<int32_t>(parameters[name]);
    } else {
        *static_cast<float *>(value) = static_cast<float>(parameters[name]);
    }
    return 0;
}

inline void mavlink_log(const char *severity, const char *format, ...) {
    va_list values;
    va_start(values, format);
    printf("%s ", severity);
    vprintf(format, values);
    printf("\n");
    va_end(values);
}
#define mavlink_log_critical(pub, ...) mavlink_log("critical", __VA_ARGS__)
#define mavlink_log_warning(pub, ...) mavlink_log("warning", __VA_ARGS__)
#define mavlink_log_info(pub, ...) mavlink_log("info", __VA_ARGS__)
