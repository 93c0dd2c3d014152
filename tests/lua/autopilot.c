/* Runs a script as ArduPilot does, over a flight from standard input.
 *
 * Lua is built with LUA_32BITS, as on the autopilot: floats and integers of 32 bits, and with the autopilot's limits of local
 * variables and upvalues. The script has only ArduPilot's globals. Each call has the autopilot's budget of
 * instructions, and a full collection follows it.
 *
 *     autopilot SCRIPT MOTORS FIRST_US NAME=VALUE...
 *
 * FIRST_US is the clock at the first record; the parameters follow. A record of the flight is doubles: the time in us since the
 * first record, whether flying, the output of each motor in us (NaN: none), and the remaining battery in % (NaN: not
 * monitored). The parameter BROKEN=1 makes a binding fail, and SCR_HEAP_SIZE limits the heap. It writes lines: `log RECORD RISK
 * ELEVATED LEVEL`, `float RECORD NAME VALUE`, `text RECORD SEVERITY TEXT`, `blocks RECORD WHY` if the autopilot cannot be
 * armed, `ended RECORD` if the script returns no function to call, and at the end the measures: `calls`, `instructions` (the
 * maximum of a call at the start, the maximum of other calls, their mean), `heap` (the bytes of a pointer; the bytes in use
 * before the script, with it after a collection, and the peaks at the start and in flight). */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lua.h"
#include "lauxlib.h"
#include "lualib.h"

#define BUDGET 10000 /* SCR_VM_I_COUNT */
#define MOTORS 32

_Static_assert(sizeof(lua_Number) == 4 && sizeof(lua_Integer) == 4, "build it with LUA_32BITS");

#define STARTING_CALLS 40 /* before the flight */

static size_t used, most_used, heap_size = SIZE_MAX;
static long instructions;
static long record = -1;
static int motors;
static double first_us, now[3 + MOTORS];
static int parameters;
static char **parameter;
static struct {
    char name[32];
    float value;
} added[8];
static int tables;

/* Like ArduPilot's heap: memory is never resized in place, and shrinking never fails. */
static void *allocate(void *nothing, void *memory, size_t before, size_t size) {
    (void)nothing;
    if (!memory) {
        before = 0;
    }
    if (size == 0) {
        used -= before;
        free(memory);
        return NULL;
    }
    void *found = used + size > heap_size ? NULL : malloc(size);
    if (!found) {
        return memory && before >= size ? memory : NULL;
    }
    used += size;
    if (used > most_used) {
        most_used = used;
    }
    if (memory) {
        memcpy(found, memory, before < size ? before : size);
        used -= before;
        free(memory);
    }
    return found;
}

static void count(lua_State *L, lua_Debug *where) {
    (void)where;
    if (++instructions > BUDGET) {
        luaL_error(L, "Exceeded CPU time");
    }
}

static uint32_t *new_time(lua_State *L, uint32_t us) {
    uint32_t *time = lua_newuserdata(L, sizeof *time);
    *time = us;
    luaL_setmetatable(L, "uint32_t");
    return time;
}

static int time_sub(lua_State *L) {
    uint32_t *a = luaL_checkudata(L, 1, "uint32_t"), *b = luaL_checkudata(L, 2, "uint32_t");
    new_time(L, *a - *b);
    return 1;
}

static int time_toint(lua_State *L) {
    lua_pushinteger(L, (lua_Integer) * (uint32_t *)luaL_checkudata(L, 1, "uint32_t"));
    return 1;
}

static int get_micros(lua_State *L) {
    new_time(L, (uint32_t)(uint64_t)(first_us + now[0]));
    return 1;
}

/* The number of the motor of an output function; 0 for others. */
static int motor_of(lua_Integer function) {
    return function >= 33 && function <= 40 ? (int)function - 32 : function >= 82 && function <= 85 ? (int)function - 73 : 0;
}

static int get_output_pwm(lua_State *L) {
    lua_Integer function = luaL_checkinteger(L, 2);
    int motor = motor_of(function);
    /* This firmware does not support functions over 150. */
    luaL_argcheck(L, function >= 0 && function <= 150, 2, "out of range");
    if (motor < 1 || motor > motors || isnan(now[1 + motor])) {
        return 0;
    }
    lua_pushinteger(L, (lua_Integer)now[1 + motor]);
    return 1;
}

static int get_likely_flying(lua_State *L) {
    for (int i = 0; i < parameters; i++) {
        if (!strcmp(parameter[i], "BROKEN=1") && record > 0) {
            luaL_error(L, "this vehicle tells nothing");
        }
    }
    lua_pushboolean(L, now[1] != 0);
    return 1;
}

static int capacity_remaining_pct(lua_State *L) {
    luaL_argcheck(L, luaL_checkinteger(L, 2) == 0, 2, "no such battery");
    if (isnan(now[2 + motors])) {
        return 0;
    }
    lua_pushinteger(L, (lua_Integer)now[2 + motors]);
    return 1;
}

/* Between 16 and 18 V. */
static int voltage(lua_State *L) {
    luaL_argcheck(L, luaL_checkinteger(L, 2) == 0, 2, "no such battery");
    if (isnan(now[2 + motors])) {
        return 0;
    }
    lua_pushnumber(L, (lua_Number)(16 + now[2 + motors] / 50));
    return 1;
}

static int param_get(lua_State *L) {
    const char *name = luaL_checkstring(L, 2);
    size_t length = strlen(name);
    for (int i = 0; i < parameters; i++) {
        if (!strncmp(parameter[i], name, length) && parameter[i][length] == '=') {
            lua_pushnumber(L, (lua_Number)atof(parameter[i] + length + 1));
            return 1;
        }
    }
    for (int i = 0; i < 8; i++) {
        if (tables && !strncmp(name, "FRISK_", 6) && !strcmp(name + 6, added[i].name)) {
            lua_pushnumber(L, added[i].value);
            return 1;
        }
    }
    return 0;
}

static int add_table(lua_State *L) {
    lua_Integer key = luaL_checkinteger(L, 2), count = luaL_checkinteger(L, 4);
    luaL_argcheck(L, key >= 0 && key <= 200, 2, "key");
    luaL_argcheck(L, count >= 1 && count <= 8, 4, "count");
    tables = !strcmp(luaL_checkstring(L, 3), "FRISK_");
    lua_pushboolean(L, tables);
    return 1;
}

static int add_param(lua_State *L) {
    lua_Integer i = luaL_checkinteger(L, 3);
    luaL_argcheck(L, i >= 1 && i <= 8, 3, "index");
    snprintf(added[i - 1].name, sizeof added[0].name, "%s", luaL_checkstring(L, 4));
    added[i - 1].value = luaL_checknumber(L, 5);
    lua_pushboolean(L, 1);
    return 1;
}

static int send_text(lua_State *L) {
    lua_Integer severity = luaL_checkinteger(L, 2);
    const char *text = luaL_checkstring(L, 3);
    luaL_argcheck(L, severity >= 0 && severity <= 7, 2, "severity");
    luaL_argcheck(L, strlen(text) <= 50, 3, "a text of more than 50 characters");
    printf("text %ld %d %s\n", record, (int)severity, text);
    return 0;
}

static int send_named_float(lua_State *L) {
    const char *name = luaL_checkstring(L, 2);
    luaL_argcheck(L, strlen(name) <= 10, 2, "a name of more than 10 characters");
    printf("float %ld %s %.9g\n", record, name, luaL_checknumber(L, 3));
    return 0;
}

static int log_write(lua_State *L) {
    luaL_argcheck(L, strlen(luaL_checkstring(L, 2)) == 4, 2, "a name of 4 characters");
    luaL_checkstring(L, 3);
    luaL_argcheck(L, !strcmp(luaL_checkstring(L, 4), "ffB"), 4, "format");
    printf("log %ld %.9g %.9g %d\n", record, luaL_checknumber(L, 5), luaL_checknumber(L, 6), (int)luaL_checkinteger(L, 7));
    return 0;
}

static const luaL_Reg TIME[] = {{"__sub", time_sub}, {"toint", time_toint}, {NULL, NULL}};
static const luaL_Reg SERVOS[] = {{"get_output_pwm", get_output_pwm}, {NULL, NULL}};
static const luaL_Reg VEHICLE[] = {{"get_likely_flying", get_likely_flying}, {NULL, NULL}};
static const luaL_Reg BATTERY[] = {{"capacity_remaining_pct", capacity_remaining_pct}, {"voltage", voltage}, {NULL, NULL}};
static const luaL_Reg PARAM[] = {{"get", param_get}, {"add_table", add_table}, {"add_param", add_param}, {NULL, NULL}};
static const luaL_Reg GCS[] = {{"send_text", send_text}, {"send_named_float", send_named_float}, {NULL, NULL}};
static const luaL_Reg LOGGER[] = {{"write", log_write}, {NULL, NULL}};

static void open_autopilot(lua_State *L) {
    static const char *const ABSENT[] = {"collectgarbage", "dofile", "loadfile", "getmetatable", "print", "rawequal", "rawlen",
                                         "rawget",         "rawset", "select",   "xpcall",       "_G",    "_VERSION"};
    const struct {
        const char *name;
        const luaL_Reg *functions;
    } globals[] = {{"SRV_Channels", SERVOS}, {"vehicle", VEHICLE}, {"battery", BATTERY}, {"param", PARAM}, {"gcs", GCS}, {"logger", LOGGER}};
    luaL_requiref(L, "_G", luaopen_base, 1);
    luaL_requiref(L, "math", luaopen_math, 1);
    luaL_requiref(L, "table", luaopen_table, 1);
    luaL_requiref(L, "string", luaopen_string, 1);
    luaL_requiref(L, "io", luaopen_io, 1);
    lua_settop(L, 0);
    for (size_t i = 0; i < sizeof ABSENT / sizeof *ABSENT; i++) {
        lua_pushnil(L);
        lua_setglobal(L, ABSENT[i]);
    }
    for (size_t i = 0; i < sizeof globals / sizeof *globals; i++) {
        lua_newtable(L);
        luaL_setfuncs(L, globals[i].functions, 0);
        lua_setglobal(L, globals[i].name);
    }
    luaL_newmetatable(L, "uint32_t");
    luaL_setfuncs(L, TIME, 0);
    lua_pushvalue(L, -1);
    lua_setfield(L, -2, "__index");
    lua_settop(L, 0);
    lua_register(L, "micros", get_micros);
}

/* Calls the function on the stack, and replaces it by the next one. An error, or a result that is neither empty nor a
 * function and a time, blocks arming. */
static int call(lua_State *L) {
    instructions = 0;
    lua_sethook(L, count, LUA_MASKCOUNT, 1);
    int failed = lua_pcall(L, 0, LUA_MULTRET, 0);
    lua_sethook(L, NULL, 0, 0);
    int results = lua_gettop(L);
    if (!failed && results == 0) {
        printf("ended %ld\n", record);
        return 0;
    }
    if (failed || results != 2 || !lua_isfunction(L, 1) || !lua_isnumber(L, 2)) {
        printf("blocks %ld %s\n", record, failed ? lua_tostring(L, -1) : "no function and no time to call it");
        return 0;
    }
    lua_settop(L, 1);
    lua_gc(L, LUA_GCCOLLECT, 0);
    return 1;
}

int main(int arguments, char **argument) {
    if (arguments < 4) {
        return 2;
    }
    motors = atoi(argument[2]);
    first_us = atof(argument[3]);
    parameters = arguments - 4;
    parameter = argument + 4;
    for (int i = 0; i < 3 + MOTORS; i++) {
        now[i] = NAN;
    }
    if (motors < 0 || motors > MOTORS) {
        return 2;
    }
    for (int i = 0; i < parameters; i++) {
        sscanf(parameter[i], "SCR_HEAP_SIZE=%zu", &heap_size);
    }
    lua_State *L = lua_newstate(allocate, NULL);
    if (!L) {
        return 2;
    }
    open_autopilot(L);
    lua_gc(L, LUA_GCCOLLECT, 0);
    size_t before = used;
    most_used = used;
    now[0] = 0;
    now[1] = 0;
    for (int i = 0; i < motors; i++) {
        now[2 + i] = 1000;
    }
    int runs = !luaL_loadfile(L, argument[1]);
    if (!runs) {
        printf("blocks -1 %s\n", lua_tostring(L, -1));
    }
    long at_start = 0, most = 0, calls = 0;
    double sum = 0;
    size_t kept = 0;
    for (int i = 0; runs && i < STARTING_CALLS; i++) {
        runs = call(L);
        at_start = instructions > at_start ? instructions : at_start;
    }
    size_t most_at_start = most_used;
    most_used = used;
    while (runs && fread(now, sizeof(double), 3 + (size_t)motors, stdin) == 3 + (size_t)motors) {
        record++;
        runs = call(L);
        calls++;
        sum += instructions;
        most = instructions > most ? instructions : most;
        kept = used > kept ? used : kept;
    }
    printf("calls %ld\ninstructions %ld %ld %.1f\n", calls, at_start, most, calls ? sum / calls : 0.0);
    printf("heap %zu %zu %zu %zu %zu\n", sizeof(void *), before, kept, most_at_start, most_used);
    lua_close(L);
    return 0;
}
