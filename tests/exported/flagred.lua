-- The profile `flagred` with the rule set `flagred`, written by `flagred export --lua` 0.1.0. Do not edit.
--
-- Copy it to APM/scripts on the card. It reads the motor outputs and reports how close the vehicle is to losing control:
-- FR_RISK and FR_ELEV in %, and a text when the level changes. It changes nothing on the vehicle. Installation, cost and
-- tests: docs/on-ardupilot.md of FLAGRED.
--
-- An error while ArduPilot loads a script blocks arming. So ArduPilot compiles only this loader; the rest of the file is a
-- comment to it. The loader reads the file again and compiles it part by part, which takes less memory than all at once, and
-- where that fails, it sends a text and ends. Parts end at a form feed; this table is their environment.

local shared = {
  floor = math.floor, sqrt = math.sqrt, exp = math.exp, abs = math.abs, huge = math.huge, min = math.min, max = math.max,
  format = string.format, sub = string.sub, match = string.match, gmatch = string.gmatch, rep = string.rep,
  unpack = table.unpack, ipairs = ipairs, error = error, pcall = pcall, tonumber = tonumber, tostring = tostring,
  gcs = gcs, param = param, micros = micros, vehicle = vehicle, logger = logger, SRV_Channels = SRV_Channels,
}
local PARTS = {"motors", "setup", "geometry", "start", "windows", "rules", "inputs", "levels", "notices", "balance", "flight", "calls", "elevated", "words", "texts"}
local number, chunk = 1, nil -- of the next part; what is compiled of it
local file, text, is_over = nil, "", false -- what is read but not compiled, and whether the part has ended

local function open()
  if not load then
    error("needs ArduPilot 4.4 or newer", 0)
  end
  local _, place = pcall(function()
    error("")
  end)
  local path = string.match(place, "^(.*):%d+:")
  file = path and io.open(path, "r")
  if not file then
    error("cannot read its own file", 0)
  end
end

-- The next piece of a part; nil or empty at its end.
local function piece()
  if is_over then
    return nil
  end
  if text == "" then
    text = file:read(400) or error("its file is cut off", 0)
  end
  local found = text
  local mark = string.find(text, "\f", 1, true)
  if mark then
    found, is_over = string.sub(text, 1, mark - 1), true
  end
  text = string.sub(text, #found + 2)
  return found
end

-- Compiles the next part, or runs what is compiled. Returns whether there is more to do.
local function go_on()
  if chunk then
    local part = chunk
    chunk, number = nil, number + 1
    part()
    return number <= #PARTS
  end
  is_over = false
  if not file then
    open()
    while (piece() or "") ~= "" do
    end
    return true
  end
  local why
  chunk, why = load(piece, "=" .. PARTS[number], "t", shared)
  if not chunk then
    error(why, 0)
  end
  return true
end

local function load_all()
  local is_well, continues = pcall(go_on)
  if is_well and continues then
    return load_all, 10
  end
  if file then
    file:close()
  end
  if is_well then
    return shared.begin, 30
  end
  local why = string.find(continues, "not enough mem", 1, true) and "increase SCR_HEAP_SIZE" or continues
  gcs:send_text(3, string.sub("FLAGRED is off: " .. why, 1, 50))
end

return load_all, 1000

--[==[
-- Time. Whole microseconds that wrap after 71 min; only differences of under 35 min are used.

clock_us = 0
held_us, held_s = 0, 0.0 -- since the last call
bin, bin_us = 0, 0 -- the bin of commands, and the time into it
has_moved = false -- whether this call has done one of the longer works

function later(us, by_us)
  return us < 1000000000 and us + by_us or us
end

-- Motors. A command is 0 at the lower limit of the range that is used in flight, 1 at the upper one.

motors, functions, numbers = 0, {}, {} -- how many; function and number of each output
command = {}
local low_us, scale = 1000.0, 0.001
less_yaw = {} -- the commands without the part that turns the nose
margin = {} -- how far each motor is from its nearer limit
yaw_factor, has_geometry = {}, false
opposite = {} -- the motor on the other side; nil where there is none

local function pair(low, high, least, most, width)
  low, high = low and param:get(low), high and param:get(high)
  if low and high and low >= least and high <= most and high - low >= width then
    return low, high
  end
end

-- Reads MOT_PWM_MIN and MAX, or the range of the throttle's channel, and the part of it from MOT_SPIN_MIN to MAX. Returns the
-- limits in us; nil where they are not valid.
function read_limits()
  local own = param:get("MOT_PWM_MIN")
  local low, high
  if own and own > 0 then
    low, high = pair("MOT_PWM_MIN", "MOT_PWM_MAX", 500, 2500, 100)
  else
    local channel = format("RC%.0f_", param:get("RCMAP_THROTTLE") or 3)
    low, high = pair(channel .. "MIN", channel .. "MAX", 500, 2500, 100)
  end
  if not low then
    return nil
  end
  local spin_low, spin_high = pair("MOT_SPIN_MIN", "MOT_SPIN_MAX", 0, 1, 0.1)
  spin_low, spin_high = spin_low or 0, spin_high or 1
  low_us = low + spin_low * (high - low)
  scale = 1 / ((spin_high - spin_low) * (high - low))
  return low_us, low_us + 1 / scale
end

-- The sum is nil where the commands are unknown.
function read_commands()
  local low_us, scale, command = low_us, scale, command
  local total = 0.0
  yaw_effort = has_geometry and 0.0 or nil
  for i = 1, motors do
    local pwm = SRV_Channels:get_output_pwm(functions[i])
    if not pwm then
      sum = nil
      yaw_effort = nil
      return
    end
    local e = (pwm - low_us) * scale
    if e < 0 then
      e = 0.0
    elseif e > 1 then
      e = 1.0
    end
    command[i] = e
    margin[i] = e < 0.5 and e or 1 - e
    total = total + e
    if has_geometry then
      yaw_effort = yaw_effort + yaw_share[i] * e
    end
  end
  sum = total
  for i = 1, motors do
    less_yaw[i] = has_geometry and command[i] - yaw_factor[i] * yaw_effort or command[i]
  end
end

function deviation_of(list)
  local mean, square = 0.0, 0.0
  for i = 1, motors do
    mean = mean + list[i]
  end
  mean = mean / motors
  for i = 1, motors do
    local d = list[i] - mean
    square = square + d * d
  end
  return sqrt(square / motors)
end

function mean_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i]
  end
  return total / motors
end

function share_of_below(list, limit)
  local count = 0
  for i = 1, motors do
    if list[i] < limit then
      count = count + 1
    end
  end
  return count / motors
end
-- Parameters and motors, found once.

local PARAMETERS = {
  {"ENABLE", 1.0},
  {"WARN", 66.0},
  {"FAIL", 80.0},
}

local function add_parameters()
  local added = param:add_table(157, "FRISK_", #PARAMETERS)
  for i, parameter in ipairs(PARAMETERS) do
    added = added and param:add_param(157, i, parameter[1], parameter[2])
  end
  if not added then
    gcs:send_text(4, "FLAGRED: no parameters, the defaults hold")
  end
end

local function output(motor_function)
  -- Older firmware has fewer functions, and refuses the others.
  local is_known, pwm = pcall(SRV_Channels.get_output_pwm, SRV_Channels, motor_function)
  return is_known and pwm
end

local function find_motors()
  local is_tri = param:get("FRAME_CLASS") == 7
  for number = 1, 32 do
    local motor_function = number <= 8 and number + 32 or number <= 12 and number + 73 or number + 147
    -- Motor 7 of a tricopter is a servo.
    if output(motor_function) and not (is_tri and number == 7) then
      motors = motors + 1
      functions[motors], numbers[motors] = motor_function, number
    end
  end
end

add_parameters()
find_motors()
if motors == 0 or not read_limits() then
  error("no motors or no limits", 0)
end
-- The geometry, read once.

-- The frames of ArduPilot: class and type, name, and number, roll, pitch and yaw factor of each motor. One text, since many
-- short ones take more memory to load.
local FRAMES = [[

1/0 QUAD/PLUS 1: -1 0 1 2: 1 0 1 3: 0 1 -1 4: 0 -1 -1
1/1 QUAD/X 1: -1 1 1 2: 1 -1 1 3: 1 1 -1 4: -1 -1 -1
1/2 QUAD/V 1: -1 1 0.7981 2: 1 -1 1 3: 1 1 -0.7981 4: -1 -1 -1
1/3 QUAD/H 1: -1 1 -1 2: 1 -1 -1 3: 1 1 1 4: -1 -1 1
1/4 QUAD/VTAIL 1: -1 0.5320889 0 2: 0 -1 -1 3: 1 0.5320889 0 4: 0 -1 1
1/5 QUAD/ATAIL 1: -1 0.5320889 0 2: 0 -1 1 3: 1 0.5320889 0 4: 0 -1 -1
1/6 QUAD/PLUSREV 1: -1 0 -1 2: 1 0 -1 3: 0 1 1 4: 0 -1 1
1/12 QUAD/BF_X 1: -1 -1 -1 2: -1 1 1 3: 1 -1 1 4: 1 1 -1
1/13 QUAD/DJI_X 1: -1 1 1 2: 1 1 -1 3: 1 -1 1 4: -1 -1 -1
1/14 QUAD/CW_X 1: -1 1 1 2: -1 -1 -1 3: 1 -1 1 4: 1 1 -1
1/16 QUAD/NYT_PLUS 1: -1 0 0 2: 1 0 0 3: 0 1 0 4: 0 -1 0
1/17 QUAD/NYT_X 1: -1 1 0 2: 1 -1 0 3: 1 1 0 4: -1 -1 0
1/18 QUAD/X_REV 1: -1 -1 1 2: -1 1 -1 3: 1 -1 -1 4: 1 1 1
1/19 QUAD/Y4 1: -1 1 1 2: 0 -1 -1 3: 0 -1 1 4: 1 1 -1
2/0 HEXA/PLUS 1: 0 1 -1 2: 0 -1 1 3: 1 -0.5 -1 4: -1 0.5 1 5: 1 0.5 1 6: -1 -0.5 -1
2/1 HEXA/X 1: -1 0 -1 2: 1 0 1 3: 0.5 1 -1 4: -0.5 -1 1 5: -0.5 1 1 6: 0.5 -1 -1
2/3 HEXA/H 1: -1 0 -1 2: 1 0 1 3: 1 1 -1 4: -1 -1 1 5: -1 1 1 6: 1 -1 -1
2/13 HEXA/DJI_X 1: -0.5 1 1 2: 0.5 1 -1 3: 1 0 1 4: 0.5 -1 -1 5: -0.5 -1 1 6: -1 0 -1
2/14 HEXA/CW_X 1: -0.5 1 1 2: -1 0 -1 3: -0.5 -1 1 4: 0.5 -1 -1 5: 1 0 1 6: 0.5 1 -1
3/0 OCTA/PLUS 1: 0 1 -1 2: 0 -1 -1 3: -0.70710677 0.70710677 1 4: -0.70710677 -0.70710677 1 5: 0.70710677 0.70710677 1 6: 0.70710677 -0.70710677 1 7: 1 0 -1 8: -1 0 -1
3/1 OCTA/X 1: -0.41421357 1 -1 2: 0.41421357 -1 -1 3: -1 0.41421357 1 4: -0.41421357 -1 1 5: 0.41421357 1 1 6: 1 -0.41421357 1 7: 1 0.41421357 -1 8: -1 -0.41421357 -1
3/2 OCTA/V 1: 0.83 0.34 -1 2: -0.67 -0.32 -1 3: 0.67 -0.32 1 4: -0.5 -1 1 5: 1 1 1 6: -0.83 0.34 1 7: -1 1 -1 8: 0.5 -1 -1
3/3 OCTA/H 1: -1 1 -1 2: 1 -1 -1 3: -1 0.333 1 4: -1 -1 1 5: 1 1 1 6: 1 -0.333 1 7: 1 0.333 -1 8: -1 -0.333 -1
3/13 OCTA/DJI_X 1: -0.41421357 1 1 2: 0.41421357 1 -1 3: 1 0.41421357 1 4: 1 -0.41421357 -1 5: 0.41421357 -1 1 6: -0.41421357 -1 -1 7: -1 -0.41421357 1 8: -1 0.41421357 -1
3/14 OCTA/CW_X 1: -0.41421357 1 1 2: -1 0.41421357 -1 3: -1 -0.41421357 1 4: -0.41421357 -1 -1 5: 0.41421357 -1 1 6: 1 -0.41421357 -1 7: 1 0.41421357 1 8: 0.41421357 1 -1
3/15 OCTA/I 1: 0.333 -1 -1 2: -0.333 1 -1 3: 1 -1 1 4: 0.333 1 1 5: -0.333 -1 1 6: -1 1 1 7: -1 -1 -1 8: 1 1 -1
4/0 OCTAQUAD/PLUS 1: 0 1 1 2: 1 0 -1 3: 0 -1 1 4: -1 0 -1 5: 1 0 1 6: 0 1 -1 7: -1 0 1 8: 0 -1 -1
4/1 OCTAQUAD/X 1: -1 1 1 2: 1 1 -1 3: 1 -1 1 4: -1 -1 -1 5: 1 1 1 6: -1 1 -1 7: -1 -1 1 8: 1 -1 -1
4/2 OCTAQUAD/V 1: -1 1 0.7981 2: 1 1 -0.7981 3: 1 -1 1 4: -1 -1 -1 5: 1 1 0.7981 6: -1 1 -0.7981 7: -1 -1 1 8: 1 -1 -1
4/3 OCTAQUAD/H 1: -1 1 -1 2: 1 1 1 3: 1 -1 -1 4: -1 -1 1 5: 1 1 -1 6: -1 1 1 7: -1 -1 -1 8: 1 -1 1
4/12 OCTAQUAD/BF_X 1: -1 -1 -1 2: -1 1 1 3: 1 -1 1 4: 1 1 -1 5: -1 -1 1 6: -1 1 -1 7: 1 -1 -1 8: 1 1 1
4/14 OCTAQUAD/CW_X 1: -1 1 1 2: -1 1 -1 3: -1 -1 -1 4: -1 -1 1 5: 1 -1 1 6: 1 -1 -1 7: 1 1 -1 8: 1 1 1
4/18 OCTAQUAD/X_REV 1: -1 -1 1 2: -1 1 -1 3: 1 -1 -1 4: 1 1 1 5: -1 -1 -1 6: -1 1 1 7: 1 -1 1 8: 1 1 -1
4/20 OCTAQUAD/X_COR 1: -1 1 1 2: 1 1 -1 3: 1 -1 1 4: -1 -1 -1 5: 1 1 -1 6: -1 1 1 7: -1 -1 -1 8: 1 -1 1
4/21 OCTAQUAD/CW_X_COR 1: -1 1 1 2: -1 1 1 3: -1 -1 -1 4: -1 -1 -1 5: 1 -1 1 6: 1 -1 1 7: 1 1 -1 8: 1 1 -1
5/0 Y6/PLUS 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/1 Y6/X 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/2 Y6/V 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/3 Y6/H 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/4 Y6/VTAIL 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/5 Y6/ATAIL 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/6 Y6/PLUSREV 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/10 Y6/Y6B 1: -1 0.5 -1 2: -1 0.5 1 3: 0 -1 -1 4: 0 -1 1 5: 1 0.5 -1 6: 1 0.5 1
5/11 Y6/Y6F 1: 0 -1 1 2: -1 0.5 1 3: 1 0.5 1 4: 0 -1 -1 5: -1 0.5 -1 6: 1 0.5 -1
5/12 Y6/BF_X 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/13 Y6/DJI_X 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/14 Y6/CW_X 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/15 Y6/I 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/16 Y6/NYT_PLUS 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/17 Y6/NYT_X 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/18 Y6/X_REV 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/19 Y6/Y4 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/20 Y6/X_COR 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
5/21 Y6/CW_X_COR 1: -1 0.4996249 1 2: 1 0.4996249 -1 3: 1 0.4996249 1 4: 0 -1 -1 5: -1 0.4996249 -1 6: 0 -1 1
7/0 TRI/PLUS 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/1 TRI/X 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/2 TRI/V 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/3 TRI/H 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/4 TRI/VTAIL 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/5 TRI/ATAIL 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/6 TRI/PLUSREV 1: -1 -0.5 0 2: 1 -0.5 0 4: 0 1 0
7/10 TRI/Y6B 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/11 TRI/Y6F 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/12 TRI/BF_X 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/13 TRI/DJI_X 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/14 TRI/CW_X 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/15 TRI/I 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/16 TRI/NYT_PLUS 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/17 TRI/NYT_X 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/18 TRI/X_REV 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/19 TRI/Y4 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/20 TRI/X_COR 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
7/21 TRI/CW_X_COR 1: -1 0.5 0 2: 1 0.5 0 4: 0 -1 0
12/0 DODECAHEXA/PLUS 1: 0 1 1 2: 0 1 -1 3: -1 0.5 -1 4: -1 0.5 1 5: -1 -0.5 1 6: -1 -0.5 -1 7: 0 -1 -1 8: 0 -1 1 9: 1 -0.5 1 10: 1 -0.5 -1 11: 1 0.5 -1 12: 1 0.5 1
12/1 DODECAHEXA/X 1: -0.5 1 1 2: -0.5 1 -1 3: -1 0 -1 4: -1 0 1 5: -0.5 -1 1 6: -0.5 -1 -1 7: 0.5 -1 -1 8: 0.5 -1 1 9: 1 0 1 10: 1 0 -1 11: 0.5 1 -1 12: 0.5 1 1
14/0 DECA/PLUS 1: 0 1 1 2: -0.618034 0.809017 -1 3: -1 0.309017 1 4: -1 -0.309017 -1 5: -0.618034 -0.809017 1 6: 0 -1 -1 7: 0.618034 -0.809017 1 8: 1 -0.309017 -1 9: 1 0.309017 1 10: 0.618034 0.809017 -1
14/1 DECA/X 1: -0.309017 1 1 2: -0.809017 0.618034 -1 3: -1 0 1 4: -0.809017 -0.618034 -1 5: -0.309017 -1 1 6: 0.309017 -1 -1 7: 0.809017 -0.618034 1 8: 1 0 -1 9: 0.809017 0.618034 1 10: 0.309017 1 -1
14/14 DECA/CW_X 1: -0.309017 1 1 2: -0.809017 0.618034 -1 3: -1 0 1 4: -0.809017 -0.618034 -1 5: -0.309017 -1 1 6: 0.309017 -1 -1 7: 0.809017 -0.618034 1 8: 1 0 -1 9: 0.809017 0.618034 1 10: 0.309017 1 -1
]]

-- Solves four equations by elimination with pivots; nil where they do not have one solution.
local function solve(rows, right)
  for step = 1, 4 do
    local pivot = step
    for row = step + 1, 4 do
      if abs(rows[row][step]) > abs(rows[pivot][step]) then
        pivot = row
      end
    end
    if abs(rows[pivot][step]) < 1e-6 then
      return nil
    end
    rows[step], rows[pivot] = rows[pivot], rows[step]
    right[step], right[pivot] = right[pivot], right[step]
    for row = step + 1, 4 do
      local factor = rows[row][step] / rows[step][step]
      for column = step, 4 do
        rows[row][column] = rows[row][column] - factor * rows[step][column]
      end
      right[row] = right[row] - factor * right[step]
    end
  end
  for step = 4, 1, -1 do
    for column = step + 1, 4 do
      right[step] = right[step] - rows[step][column] * right[column]
    end
    right[step] = right[step] / rows[step][step]
  end
  return right
end

-- How much of an effort (1 roll, 2 pitch, 3 yaw, 4 thrust) a unit of command of each motor is: the axis' row of the
-- pseudo-inverse of all factors.
local function shares_of(factors, axis)
  local rows, right = {}, {0.0, 0.0, 0.0, 0.0}
  for a = 1, 4 do
    rows[a] = {0.0, 0.0, 0.0, 0.0}
    local acts = false
    for _, motor in ipairs(factors) do
      for b = 1, 4 do
        rows[a][b] = rows[a][b] + motor[a] * motor[b]
      end
      acts = acts or motor[a] ~= 0
    end
    if not acts then
      rows[a][a] = 1.0
    end
  end
  right[axis] = 1.0
  local solved = solve(rows, right)
  local shares = {}
  for i, motor in ipairs(factors) do
    if not solved then
      return nil
    end
    shares[i] = motor[1] * solved[1] + motor[2] * solved[2] + motor[3] * solved[3] + motor[4] * solved[4]
  end
  return shares
end

-- The motor on the other side of the middle; of two on one arm the one that turns the same way.
local function find_opposites(factors)
  for i, motor in ipairs(factors) do
    local least = huge
    for other, factor in ipairs(factors) do
      if abs(factor[1] + motor[1]) < 0.1 and abs(factor[2] + motor[2]) < 0.1 then
        local is_in_the_middle = abs(motor[1]) < 0.1 and abs(motor[2]) < 0.1
        local turns = abs(factor[3] - motor[3])
        if has_geometry and not is_in_the_middle and turns < least then
          least, opposite[i] = turns, other
        end
      end
    end
  end
end

local function read_geometry()
  local class, kind = param:get("FRAME_CLASS"), param:get("FRAME_TYPE")
  local frame = class and kind and match(FRAMES, format("\n%.0f/%.0f [^:]* (%%d+: [^\n]*)", class, kind))
  local factors, known = {}, 0
  for number, roll, pitch, yaw in gmatch(frame or "", "(%d+): (%S+) (%S+) (%S+)") do
    known = known + 1
    for i = 1, motors do
      if numbers[i] == tonumber(number) then
        factors[i] = {tonumber(roll) + 0.0, tonumber(pitch) + 0.0, tonumber(yaw) + 0.0, 1.0}
      end
    end
  end
  if #factors ~= motors or known ~= motors then
    gcs:send_text(6, "FLAGRED: frame unknown, turning counts")
    return
  end
  yaw_share = shares_of(factors, 3)
  has_geometry = yaw_share and true or false
  for i = 1, motors do
    yaw_factor[i] = factors[i][3]
  end
  find_opposites(factors)
end

read_geometry()
-- The windows, made once.

windows, inputs = {}, {} -- the inputs are rows

local NOTHING = {}

-- A list of numbers, one for each slot, which add up. Its constructor has room for all, since a table that grows takes twice the
-- memory; a slot that was never used is nil.
local function new_list(window)
  local list = {middle = 0.0, back = 0.0, unpack(NOTHING, 1, window.capacity)}
  window.lists[#window.lists + 1] = list
  return list
end

-- `capacity` is the most slots in use at once.
local function new_window(length_s, capacity)
  local window = {
    length_us = floor(length_s * 1000000), needed_s = 0.99 * min(1000000 * 1e-6, length_s), capacity = capacity,
    number = 0, phase = 0, -- the slot of the present, and 128 times the time into it
    oldest = 1, newest = 0, newest_number = nil, slots = 0, front = 0, middle = 0, back = 0, turning = 0, unturned = 0,
    samples = 0, start_us = 0, back_since_us = 0, is_full = false,
    end_us = {unpack(NOTHING, 1, capacity)}, lists = {}, rows = {},
    bin = 0, bin_samples = 0, bin_held = 0.0, bin_end_us = 0, bin_number = 0, -- the latest bin, not in a slot yet
  }
  window.weight = new_list(window, nil, 0.0)
  windows[#windows + 1] = window
  return window
end

-- A statistic of a window: the "mean", the "spread" about the mean, the "lowest" or the "highest" value. `x` is the value
-- of a sample, nil where it is unknown, and `within` the variance that one sample has in itself.
local function new_row(window, kind)
  local row = {kind = kind, x = nil, within = 0.0, shift = nil, bin_sum = 0.0, before = nil, sum = nil, square = nil}
  row.square = kind == "spread" and new_list(window, nil, 0.0) or nil
  row.sum = row.sum or new_list(window, nil, 0.0)
  window.rows[#window.rows + 1] = row
  return row
end

new_window(2.0, 24)
inputs[1] = new_row(windows[1], "spread") -- unsteady_now
inputs[3] = new_row(windows[1], "spread") -- throttle_activity
new_window(20.0, 130)
inputs[2] = new_row(windows[2], "spread") -- unsteady_lately
new_window(2.0, 70)
inputs[4] = new_row(windows[3], "mean") -- load
inputs[5] = new_row(windows[3], "mean") -- spread
inputs[6] = new_row(windows[3], "mean") -- at_limit
risks = new_window(3.0, 104)
new_row(risks, "spread")
-- Windows: sums over the last seconds, in slots of time in which samples are merged. The slots lie in a ring, in three runs: the
-- front, of whose slots each holds the sum of itself and the later ones of the front; the middle, which is made the same, two
-- slots a call; and the back, to which slots are added. So a call costs the same whatever the length, and as nothing is
-- subtracted from a sum that stays, nothing drifts.

function clear(window)
  window.slots, window.front, window.middle, window.back, window.unturned = 0, 0, 0, 0, 0
  window.oldest, window.newest, window.samples, window.is_full = 1, 0, 0, false
  window.bin_samples, window.bin_held = 0, 0.0
  for _, list in ipairs(window.lists) do
    list.middle, list.back = 0.0, 0.0
  end
  for _, row in ipairs(window.rows) do
    row.bin_sum, row.before, row.shift = 0.0, nil, nil
  end
end

-- The back becomes the middle.
local function turn(window)
  window.middle, window.back, window.unturned = window.back, 0, window.back - 1
  window.turning = window.newest
  for _, list in ipairs(window.lists) do
    list.middle, list.back = list.back, 0.0
  end
end

-- Makes slots of the middle hold the sum of themselves and the later ones.
local function sum_middle(window, count)
  while count > 0 and window.unturned > 0 do
    local later_slot = window.turning
    local slot = (later_slot - 2) % window.capacity + 1
    for _, list in ipairs(window.lists) do
      list[slot] = list[slot] + list[later_slot]
    end
    window.turning, window.unturned, count = slot, window.unturned - 1, count - 1
  end
end

-- Where the front has run out, the middle becomes the front.
local function keep_a_front(window)
  if window.front > 0 then
    return
  end
  if window.middle == 0 then
    turn(window)
    window.newest_number = nil
  end
  sum_middle(window, 128 + 2)
  window.front, window.middle = window.middle, 0
  for _, list in ipairs(window.lists) do
    list.middle = 0.0
  end
end

-- Drops what ended so long ago or longer.
function drop_older(window, us)
  while window.slots > 0 and clock_us - window.end_us[window.oldest] >= us do
    keep_a_front(window)
    window.oldest = window.oldest % window.capacity + 1
    window.front, window.slots = window.front - 1, window.slots - 1
    -- Not fewer than that many samples are left.
    window.samples = window.slots
  end
end

-- The slot for what ended at a time in a slot of that number.
local function slot_of(window, number, end_us)
  if window.slots == 0 or window.newest_number ~= number and window.slots < window.capacity then
    if window.middle == 0 and window.back > 1 and 2 * (clock_us - window.back_since_us) >= window.length_us then
      turn(window)
    end
    window.newest, window.newest_number = window.newest % window.capacity + 1, number
    if window.back == 0 then
      window.back_since_us = clock_us
    end
    if window.slots == 0 then
      window.oldest, window.start_us = window.newest, end_us
    end
    window.slots, window.back = window.slots + 1, window.back + 1
    for _, list in ipairs(window.lists) do
      list[window.newest] = 0.0
    end
  end
  sum_middle(window, 2)
  window.end_us[window.newest] = end_us
  window.samples = window.samples + 1
  return window.newest
end

local function put(list, slot, x)
  list[slot], list.back = list[slot] + x, list.back + x
end

-- Puts a value into a slot. Spreads are sums about a value near the mean, which keeps their digits.
local function merge(row, slot, held, x, rest)
  if row.kind == "mean" then
    put(row.sum, slot, held * x)
  else
    row.shift = row.shift or x
    local d = x - row.shift
    put(row.sum, slot, held * d)
    put(row.square, slot, held * (d * d + rest))
  end
end

-- The value of the latest bin, and its rest: of a spread the noise, half of the squared step from the bin before, is taken
-- away; of a mean, the squared step itself is the value.
local function of_bin(window, row)
  local x = row.bin_sum / window.bin_samples
  local step = row.before and x - row.before or 0.0
  if row.kind == "mean" then
    return x, step * step
  end
  return x, -0.5 * step * step
end

function take_bin(window)
  if window.bin_samples > 0 and window.bin ~= bin then
    local held = window.bin_held
    local slot = held > 0 and slot_of(window, window.bin_number, window.bin_end_us)
    if slot then
      put(window.weight, slot, held)
    end
    for _, row in ipairs(window.rows) do
      local x, rest = of_bin(window, row)
      if slot then
        merge(row, slot, held, row.kind == "mean" and rest or x, rest)
      end
      row.before, row.bin_sum = x, 0.0
    end
    window.bin_samples, window.bin_held = 0, 0.0
  end
  drop_older(window, window.length_us - 1)
  if window.rows[1].x then
    window.bin, window.bin_end_us, window.bin_number = bin, clock_us, window.number
    window.bin_samples = window.bin_samples + 1
    window.bin_held = window.bin_held + held_s
    for _, row in ipairs(window.rows) do
      row.bin_sum = row.bin_sum + row.x
    end
  end
end

function take_sample(window, held)
  drop_older(window, window.length_us - 1)
  if window.rows[1].x and held > 0 then
    local slot = slot_of(window, window.number, clock_us)
    put(window.weight, slot, held)
    for _, row in ipairs(window.rows) do
      merge(row, slot, held, row.x, row.within)
    end
  end
end

-- The numbers of a list together, without a share of the oldest slot.
function total_of(window, list, out)
  local sum = list.middle + list.back
  if window.front > 0 then
    local first = list[window.oldest]
    sum = sum + first
    if out > 0 then
      sum = sum - out * (window.front > 1 and first - list[window.oldest % window.capacity + 1] or first)
    end
  end
  return sum
end

-- The share of the oldest slot that has left the window.
function outside(window)
  if not window.is_full and clock_us - window.start_us < window.length_us - 100000 or window.slots == 0 then
    return 0.0
  end
  window.is_full = true
  keep_a_front(window)
  local inside_s = (window.end_us[window.oldest] - clock_us + window.length_us) * 1e-6
  local weight = window.weight
  local first = weight[window.oldest]
  local own = window.front > 1 and first - weight[window.oldest % window.capacity + 1] or first
  return inside_s < own and 1 - inside_s / own or 0.0
end

-- Sums about another value.
local function move_shift(row, window, by)
  local sum, square, weight = row.sum, row.square, window.weight
  for slot = 1, window.capacity do
    if sum[slot] then
      square[slot] = square[slot] + by * (by * weight[slot] - 2 * sum[slot])
      sum[slot] = sum[slot] - by * weight[slot]
    end
  end
  for _, run in ipairs({"middle", "back"}) do
    square[run] = square[run] + by * (by * weight[run] - 2 * sum[run])
    sum[run] = sum[run] - by * weight[run]
  end
  row.shift = row.shift + by
end

-- The mean, the lowest or the highest value; for a spread the mean and the variance.
function read_row(window, row, total, out)
  local kind, held = row.kind, window.bin_held
  local sum = total_of(window, row.sum, out)
  if kind == "mean" then
    if held > 0 then
      local _, step = of_bin(window, row)
      sum = sum + held * step
    end
    return sum / total
  end
  local square, shift = total_of(window, row.square, out), row.shift
  if held > 0 then
    local x, rest = of_bin(window, row)
    shift = shift or x
    local d = x - shift
    sum = sum + held * d
    square = square + held * (d * d + rest)
  end
  local off = sum / total
  local variance = square / total - off * off
  if off * off > 30 * variance and row.shift and not has_moved then
    has_moved = true
    move_shift(row, window, off)
  end
  return shift + off, max(variance, 0.0)
end

function deviation(window, row, total, out)
  local _, variance = read_row(window, row, total, out)
  return sqrt(variance)
end
-- The rules.

fired = {} -- the firing strengths of rules
local coverage = 0.0 -- the largest firing strength
local strengths, degrees = {}, {} -- of output terms, and of terms of inputs
is_filled = false

-- Along the corners x1, degree 1, x2, degree 2 and so on.
local function along(corners, x)
  local count = #corners
  if x < corners[1] then
    return corners[2]
  end
  for i = 3, count, 2 do
    if x < corners[i] then
      local left, low = corners[i - 2], corners[i - 1]
      return low + (corners[i + 1] - low) * ((x - left) / (corners[i] - left))
    end
  end
  return corners[count]
end

local function fire(rule, term, strength)
  if strength < 1e-12 then
    strength = 0.0
  end
  fired[rule] = strength
  strengths[term] = strengths[term] + strength
  if strength > coverage then
    coverage = strength
  end
end

-- The corners of the terms of inputs: value, degree, value, degree and so on.
local TERMS = {
  {0.0, 0.0, 0.5, 1.0}, -- at_limit much
  {0.004, 1.0, 0.02, 0.0}, -- unsteady_now calm
  {0.0, 1.0, 0.5, 0.0}, -- at_limit none
  {0.02, 0.0, 0.05, 1.0}, -- unsteady_now violent
  {0.008, 1.0, 0.02, 0.0}, -- unsteady_lately calm
  {0.008, 0.0, 0.02, 1.0, 0.04, 0.0}, -- unsteady_lately gusty
  {0.02, 0.0, 0.04, 1.0}, -- unsteady_lately stormy
  {0.003, 1.0, 0.012, 0.0}, -- throttle_activity steady
  {0.003, 0.0, 0.012, 1.0, 0.025, 0.0}, -- throttle_activity moving
  {0.012, 0.0, 0.025, 1.0}, -- throttle_activity surging
  {0.7, 0.0, 0.9, 1.0}, -- load heavy
  {0.0012, 1.0, 0.04, 0.0}, -- spread even
  {0.0012, 0.0, 0.04, 1.0}, -- spread uneven
}
local OUTPUT_TERMS = 5
-- The areas of the output's terms, and their moments about the middle of its range.
local AREAS = {5.0, 5.0, 5.0, 5.0, 5.0}
local MOMENTS = {-225.0, -125.0, 0.0, 125.0, 225.0}

-- The risk by the rules in %; nil where none fires.
local function by_rules(x)
  coverage = 0.0
  for term = 1, OUTPUT_TERMS do
    strengths[term] = 0.0
  end
  local d = degrees
  d[1] = along(TERMS[1], x[6]) -- at_limit much
  d[2] = along(TERMS[2], x[1]) -- unsteady_now calm
  d[3] = along(TERMS[3], x[6]) -- at_limit none
  d[4] = along(TERMS[4], x[1]) -- unsteady_now violent
  d[5] = along(TERMS[5], x[2]) -- unsteady_lately calm
  d[6] = along(TERMS[6], x[2]) -- unsteady_lately gusty
  d[7] = along(TERMS[7], x[2]) -- unsteady_lately stormy
  d[8] = along(TERMS[8], x[3]) -- throttle_activity steady
  d[9] = along(TERMS[9], x[3]) -- throttle_activity moving
  d[10] = along(TERMS[10], x[3]) -- throttle_activity surging
  d[11] = along(TERMS[11], x[4]) -- load heavy
  d[12] = along(TERMS[12], x[5]) -- spread even
  d[13] = along(TERMS[13], x[5]) -- spread uneven
  -- IF at_limit IS much THEN risk IS very_high
  fire(1, 5, d[1])
  -- IF unsteady_now IS calm AND at_limit IS none THEN risk IS very_low WITH 0.5
  fire(2, 1, 0.5 * d[2] * d[3])
  -- IF unsteady_now IS violent AND at_limit IS none THEN risk IS very_high
  fire(3, 5, d[4] * d[3])
  -- IF unsteady_lately IS calm AND at_limit IS none THEN risk IS very_low WITH 0.2
  fire(4, 1, 0.2 * d[5] * d[3])
  -- IF unsteady_lately IS gusty AND at_limit IS none THEN risk IS medium
  fire(5, 3, d[6] * d[3])
  -- IF unsteady_lately IS stormy AND at_limit IS none THEN risk IS very_high
  fire(6, 5, d[7] * d[3])
  -- IF throttle_activity IS steady AND at_limit IS none THEN risk IS very_low WITH 0.35
  fire(7, 1, 0.35 * d[8] * d[3])
  -- IF throttle_activity IS moving AND at_limit IS none THEN risk IS medium WITH 0.1
  fire(8, 3, 0.1 * d[9] * d[3])
  -- IF throttle_activity IS surging AND at_limit IS none THEN risk IS high WITH 0.5
  fire(9, 4, 0.5 * d[10] * d[3])
  -- IF load IS heavy AND at_limit IS none THEN risk IS high WITH 0.35
  fire(10, 4, 0.35 * d[11] * d[3])
  -- IF spread IS even AND at_limit IS none THEN risk IS low WITH 0.7
  fire(11, 2, 0.7 * d[12] * d[3])
  -- IF spread IS uneven AND at_limit IS none THEN risk IS very_high WITH 0.1
  fire(12, 5, 0.1 * d[13] * d[3])
  local area, moment = 0.0, 0.0
  for term = 1, OUTPUT_TERMS do
    area = area + strengths[term] * AREAS[term]
    moment = moment + strengths[term] * MOMENTS[term]
  end
  if area > 0 then
    return max(0.0, min(100.0, 50.0 + moment / area))
  end
  return nil -- no rule fires
end

local point = {} -- the inputs of the rules, in their order

function estimate()
  point[1] = max(0.0, min(0.5, value[1]))
  point[2] = max(0.0, min(0.5, value[2]))
  point[3] = max(0.0, min(0.5, value[3]))
  point[4] = max(0.0, min(1.0, value[4]))
  point[5] = max(0.0, min(0.5, value[5]))
  point[6] = max(0.0, min(1.0, value[6]))
  local risk = by_rules(point)
  return risk and max(0.0, min(100.0, risk))
end
-- The inputs of the rules.

value = {} -- of the inputs; nil where one is unknown

-- Takes in a sample of flight.
function observe()
  local inputs, value, windows = inputs, value, windows
  local deviation_of_less_yaw = sum and deviation_of(less_yaw) or nil
  local mean_of_command = sum and mean_of(command) or nil
  local share_of_below_margin_0_005999 = sum and share_of_below(margin, 0.005999) or nil
  inputs[1].x = deviation_of_less_yaw -- unsteady_now
  inputs[2].x = deviation_of_less_yaw -- unsteady_lately
  inputs[3].x = mean_of_command -- throttle_activity
  inputs[4].x = mean_of_command -- load
  inputs[5].x = deviation_of_less_yaw -- spread
  inputs[6].x = share_of_below_margin_0_005999 -- at_limit
  take_bin(windows[1])
  take_bin(windows[2])
  take_sample(windows[3], held_s)
end

-- The seconds that are known of a window and the share of its oldest slot that has left it; nil where too little is known.
local function enough(window)
  local out = outside(window)
  local total = total_of(window, window.weight, out) + window.bin_held
  local samples = window.samples + (window.bin_held > 0 and 1 or 0)
  if total < window.needed_s or total <= 0 or samples < 5 then
    return nil
  end
  return total, out
end

-- The inputs' values; false where one is not known.
function read_inputs()
  local inputs, value, windows = inputs, value, windows
  local all, total, out = true, nil, nil
  local window
  window = windows[1]
  total, out = enough(window)
  value[1] = total and deviation(window, inputs[1], total, out) -- unsteady_now
  all = all and value[1]
  value[3] = total and deviation(window, inputs[3], total, out) -- throttle_activity
  all = all and value[3]
  window = windows[2]
  total, out = enough(window)
  value[2] = total and deviation(window, inputs[2], total, out) -- unsteady_lately
  all = all and value[2]
  window = windows[3]
  total, out = enough(window)
  value[4] = total and read_row(window, inputs[4], total, out) -- load
  all = all and value[4]
  value[5] = total and read_row(window, inputs[5], total, out) -- spread
  all = all and value[5]
  value[6] = total and read_row(window, inputs[6], total, out) -- at_limit
  all = all and value[6]
  return all
end
-- Levels: raised after a while, held, lowered after a while.

-- What each rule is about: the area and the centre of its consequent, an input and a term, whether motors are at a limit.
CAUSES = {
  {5.0, 95.0, "at_limit", "much", true}, -- 1
  {5.0, 5.0, "unsteady_now", "calm", false}, -- 2
  {5.0, 95.0, "unsteady_now", "violent", false}, -- 3
  {5.0, 5.0, "unsteady_lately", "calm", false}, -- 4
  {5.0, 50.0, "unsteady_lately", "gusty", false}, -- 5
  {5.0, 95.0, "unsteady_lately", "stormy", false}, -- 6
  {5.0, 5.0, "throttle_activity", "steady", false}, -- 7
  {5.0, 50.0, "throttle_activity", "moving", false}, -- 8
  {5.0, 75.0, "throttle_activity", "surging", false}, -- 9
  {5.0, 75.0, "load", "heavy", false}, -- 10
  {5.0, 25.0, "spread", "even", false}, -- 11
  {5.0, 95.0, "spread", "uneven", false}, -- 12
}
warn_risk, fail_risk = 66.0, 80.0 -- parameters may change them
risk_level = 0 -- of the risk alone
local reached_at = {} -- since when the thresholds of each level are reached
local held_at = 0 -- when something last held the level
is_open, by_elevated = false, false -- the time of trouble
local open_level = 0
local seen, mean_margin, least_margin = 0, {}, {} -- the motors while a level is being reached
is_upper = {} -- whether the limit that each motor was nearest to is the upper one

-- The rule that raises the risk most: the largest share of it, above half of its value.
local function find_cause(risk)
  if is_filled then
    return nil
  end
  local most, rule = -huge, nil
  for i = 1, #CAUSES do
    local raises = (fired[i] or 0.0) * CAUSES[i][1] * (CAUSES[i][2] - risk / 2)
    if (fired[i] or 0.0) > 0 and raises > most then
      most, rule = raises, i
    end
  end
  return rule
end

local function is_reached(risk, risk_limit, elevated_limit)
  if risk_limit and risk >= risk_limit then
    return true, false
  elseif elevated_limit and elevated >= elevated_limit then
    return true, true
  end
  return false, false
end

-- The motor with the least mean margin, where it is near a limit; of motors at zero the one that is there for longest.
local function weakest()
  local found
  for i = 1, motors do
    local margin, least = mean_margin[i], found and mean_margin[found]
    if margin and (not found or margin < least) then
      found = i
    elseif margin == least and margin and (at_zero[found] or 0.0) > 0 and at_zero[i] > at_zero[found] then
      found = i
    end
  end
  return found and least_margin[found] < 0.1 and found or nil
end

local function raise(level, of_elevated, risk)
  risk_level = level
  if not is_open or open_level ~= level then
    by_elevated = of_elevated
  end
  if not is_open or level > open_level then
    cause, open_level = find_cause(risk), level
    limit_motor = cause and CAUSES[cause][5] and weakest()
  end
  is_open = true
end

-- A level reached now; gives what holds it.
local function follow(level, held, risk, can_raise, risk_limit, elevated_limit, after_us, until_risk, until_elevated)
  local reached, of_elevated = is_reached(risk, risk_limit, elevated_limit)
  reached = reached and can_raise
  if reached or is_reached(risk, until_risk, until_elevated) then
    held = min(level, risk_level)
  end
  if not reached then
    reached_at[level] = nil
    return held
  end
  reached_at[level] = reached_at[level] or clock_us
  if level > risk_level and clock_us - reached_at[level] >= after_us then
    raise(level, of_elevated, risk)
    held = level
  end
  return held
end

-- Keeps what the motors do while a level is being reached, from its beginning.
local function watch_motors(risk, takes_off)
  local warns = not takes_off and is_reached(risk, warn_risk, 2.0)
  local fails = is_reached(risk, fail_risk, nil)
  fails = fails and not sinks
  if not warns and not fails then
    return
  end
  if warns and not reached_at[2] or fails and not reached_at[3] then
    seen, mean_margin, least_margin = 0, {}, {}
  end
  seen = seen + 1
  for i = 1, motors do
    local e = command[i]
    local near = e < 0.5 and e or 1 - e
    local mean = mean_margin[i] or 0.0
    mean_margin[i] = mean + (near - mean) / seen
    if near < (least_margin[i] or huge) then
      least_margin[i], is_upper[i] = near, e >= 0.5
    end
  end
end

-- The lower of a risk that ends a level and the one that raises it.
local function lower(until_risk, risk)
  return until_risk and risk and min(until_risk, risk) or until_risk
end

doubt_us = nil -- since an alarm: for how long the motors have worked as before

-- After an alarm the level is GOOD again when the motors have worked as before for as long as a level is held.
local function doubt()
  local is_back = true
  is_back = works_as_before()
  if (risk_level > 0 or doubt_us) and not is_back then
    doubt_us = 0
  elseif risk_level == 0 and doubt_us and doubt_us >= 10000000 then
    doubt_us = nil
  end
end

function judge(risk, takes_off)
  watch_motors(risk, takes_off)
  local held, can_fail = 0, true
  can_fail = not sinks
  local warn_until, fail_until = lower(45.0, warn_risk), lower(65.0, fail_risk)
  held = follow(2, held, risk, not takes_off, warn_risk, 2.0, 200000, warn_until, 1.0)
  held = follow(3, held, risk, can_fail, fail_risk, nil, 300000, fail_until, nil)
  if held >= risk_level then
    held_at = clock_us
  elseif clock_us - held_at >= 10000000 then
    risk_level, held_at = held, clock_us
    is_open = held > 0
  end
  doubt()
end

function stop_judging()
  clear_elevated()
  risk_level, is_open = 0, false
  reached_at[2], reached_at[3] = nil, nil
end
-- What is told beside the risk, as WARN until the flight ends.

raised = false -- whether something was raised in this call

-- A moving average; until its time constant has passed, the plain mean.
local function new_average()
  return {value = 0.0, known = 0.0}
end

local function average(mean, x, constant_s)
  if held_s > 0 then
    mean.known = mean.known + held_s
    local share = held_s / max(min(mean.known, constant_s), held_s)
    mean.value = mean.value + (x - mean.value) * share
  end
end

local reserve, reserve_us = new_average(), nil
little_reserve = nil

local function watch_reserve(mean)
  average(reserve, 1 - mean, 3.0)
  if reserve.known < 3.0 or reserve.value >= 0.1 then
    reserve_us = nil
    return
  end
  reserve_us = reserve_us and later(reserve_us, held_us) or 0
  if not little_reserve and reserve_us >= 3000000 then
    raised = true
  end
  if little_reserve or raised then
    little_reserve = min(little_reserve or huge, 100 * reserve.value)
  end
end

function notice()
  raised = false
  if not sum then
    return
  end
  watch_reserve(sum / motors)
  watch_balance()
end

function forget_notices()
  reserve, reserve_us, little_reserve = new_average(), nil, nil
  forget_balance()
end
-- The balance of the motors: a motor that works harder than before, and whether all work as before.

local lately, trims, shifts = {}, {}, {} -- of each motor
at_zero = {} -- for how long each motor is at zero, in s
local lately_s, trim_s, load, load_s = 0.0, 0.0, 0.0, 0.0
local imbalance_us, weak_us -- for how long the limits have been passed
imbalance, imbalance_words = nil, nil -- in %, and what it is
unbalanced, or_unbalanced = nil, nil -- the motor that is named, and the one that it may be as well
weak, weak_motor, or_weak = nil, nil, nil -- in %, and as above
sinks = false
local is_back = false

-- The weight of this call in an average.
local function weight(known_s, constant_s)
  return held_s / max(min(known_s, constant_s), held_s)
end

-- Whether the motors are no farther apart than in the last seconds. In a fall they are.
function is_together()
  if lately_s < 5.0 or not sum then
    return true
  end
  local now, before, mean = 0.0, 0.0, sum / motors
  for i = 1, motors do
    local d = command[i] - mean
    now, before = now + d * d, before + lately[i] * lately[i]
  end
  return sqrt(now / motors) < sqrt(before / motors) + 0.05
end

-- The indices of the largest and the second largest number.
local function two_highest(list)
  local first, second
  for i = 1, motors do
    if not first or list[i] > list[first] then
      first, second = i, first
    elseif not second or list[i] > list[second] then
      second = i
    end
  end
  return first, second
end

-- The motor to name, and the other one that it may be: the highest one, where it is alone up there; otherwise the one that stopped
-- first; otherwise the highest one.
local function culprit(list)
  local first, second = two_highest(list)
  local ahead = second and list[first] - list[second] or huge
  if ahead < list[first] / 3 then
    local stopped, next_one = two_highest(at_zero)
    if at_zero[stopped] > 0 then
      return stopped, next_one and at_zero[next_one] >= at_zero[stopped] and next_one or nil
    end
  end
  return first, ahead < 0.02 and second or nil
end

local function is_near(list, usual, limit)
  for i = 1, motors do
    if abs(list[i] - (usual and usual[i] or 0.0)) >= limit then
      return false
    end
  end
  return true
end

-- The yaw effort that numbers of the motors amount to.
local function yaw_of(list)
  local yaw = 0.0
  if has_geometry then
    for i = 1, motors do
      yaw = yaw + yaw_share[i] * list[i]
    end
  end
  return yaw
end

-- How far a motor is at most above the one opposite.
local function at_odds()
  local yaw, most = yaw_of(lately), 0.0
  for i = 1, motors do
    local other = opposite[i]
    if other then
      most = max(most, lately[i] - lately[other] - (yaw_factor[i] - yaw_factor[other]) * yaw)
    end
  end
  return most
end

local function learn(mean)
  lately_s, load_s = lately_s + held_s, load_s + held_s
  load = load + (mean - load) * weight(load_s, 3.0)
  local share = weight(lately_s, 5.0)
  for i = 1, motors do
    local before = lately[i] or 0.0
    lately[i] = before + (command[i] - mean - before) * share
    at_zero[i] = command[i] > 0 and 0.0 or (at_zero[i] or 0.0) + held_s
    trims[i] = trims[i] or 0.0
  end
end

local function learn_trims(mean)
  trim_s = trim_s + held_s
  local share = weight(trim_s, 30.0)
  for i = 1, motors do
    trims[i] = trims[i] + (command[i] - mean - trims[i]) * share
  end
end

function watch_balance()
  local mean = sum / motors
  sinks = load_s >= 3.0 and mean < load / 2 and is_together()
  if held_s <= 0 then
    return
  end
  learn(mean)
  local settled, learned = lately_s >= 5.0, trim_s >= 10.0
  if risk_level == 0 and not doubt_us and (not learned or settled and is_near(lately, trims, 0.15 / 2)) then
    learn_trims(mean)
  end
  is_back = settled and (learned and is_near(lately, trims, 0.15 / 2) or not learned and is_near(lately, nil, 0.15))
  local squares = 0.0
  for i = 1, motors do
    shifts[i] = lately[i] - trims[i]
    squares = squares + shifts[i] * shifts[i]
  end
  local first, second = two_highest(shifts)
  local shift = shifts[first]
  local is_known = learned and settled
  if is_known and shift > 0.15 / 2 and shift * shift >= 0.75 * (min(motors - 1.0, 3.0) / motors) * squares then
    imbalance_us = nil
    weak_us = weak_us and later(weak_us, held_us) or 0
    if weak then
      weak = max(weak, 100 * shift)
    elseif weak_us >= 3000000 then
      weak, weak_motor, raised = 100 * shift, first, true
      or_weak = second and shift - shifts[second] < shift / 3 and second or nil
    end
    return
  end
  weak_us = nil
  local yaw, most = yaw_of(shifts), 0.0
  for i = 1, motors do
    most = max(most, abs(shifts[i] - (has_geometry and yaw_factor[i] * yaw or 0.0)))
  end
  local words, list = "imbalance", shifts
  if most <= 0.15 or not is_known then
    words, list, most = "pair imbalance", lately, settled and at_odds() / 2 or 0.0
  end
  if most <= 0.15 or weak then
    imbalance_us = nil
    return
  end
  if list == lately then
    most = 2 * most
  end
  imbalance_us = imbalance_us and later(imbalance_us, held_us) or 0
  if imbalance then
    imbalance = words == imbalance_words and max(imbalance, 100 * most) or imbalance
  elseif imbalance_us >= 3000000 then
    imbalance, imbalance_words, raised = 100 * most, words, true
    unbalanced, or_unbalanced = culprit(list)
  end
end

-- Whether all motors work as before the alarm; without a trim from before it, whether they work alike.
function works_as_before()
  return is_back
end

-- A new flight may begin.
function forget_trims()
  if trim_s > 0 then
    trims, trim_s = {}, 0.0
  end
end

function forget_balance()
  lately, at_zero, lately_s, load, load_s = {}, {}, 0.0, 0.0, 0.0
  imbalance_us, weak_us, imbalance, weak, sinks, is_back = nil, nil, nil, nil, false, false
end
-- A flight.

flown_us = nil -- since take-off; nil on the ground
down_us = nil -- for how long it seems to be on the ground
local settled, settling = false, huge -- whether the take-off is dropped, and the window to drop it from next
local idle -- "landing" or "trouble"
local since_high_us, unknown_us -- since a high risk, and since a risk was known

-- Resets the state after a flight or a gap. After a gap in the air, trims and the doubt about an alarm stay.
function forget(is_gap)
  local was_alarm = is_gap and level_now() > 0
  for _, window in ipairs(windows) do
    clear(window)
  end
  flown_us, down_us, settled, settling, idle, since_high_us, unknown_us = nil, nil, false, huge, nil, nil, nil
  value = {}
  forget_notices()
  stop_judging()
  doubt_us = was_alarm and 0 or nil
  if not is_gap then
    forget_trims()
  end
end

-- Whether the motors idle as on the ground: before take-off, and after a flight that was calm to its end. While the command of a
-- motor is unknown, the vehicle counts as in the air.
local function rests()
  if not sum then
    return false
  end
  if sum >= 0.1 * motors then
    idle = nil
    return false
  end
  if not idle then
    local is_trouble = since_high_us and since_high_us <= 2000000
    is_trouble = is_trouble or not is_together()
    idle = is_trouble and "trouble" or "landing"
  end
  return idle == "landing"
end

-- Some time after take-off, drops it from the long windows, one a call, and from the elevated risk.
local function settle()
  if not settled and flown_us >= 3000000 + 1000000 then
    settled, settling = true, 1
    if 3000000 > 0 then
      clear_elevated()
    end
  end
  while 3000000 > 0 and settling <= #windows do
    local window = windows[settling]
    settling = settling + 1
    if window.length_us > 3000000 then
      drop_older(window, flown_us - 3000000 - 1)
      return
    end
  end
end

-- Takes in the time and the motors; gives the risk in %, nil where it is unknown.
function fly()
  has_moved = false
  clock_us = clock_us + held_us
  bin_us = bin_us + held_us
  bin, bin_us = bin + bin_us // 100000, bin_us % 100000
  if held_us > 2000000 then
    forget(true)
    held_us, held_s = 0, 0.0
  end
  for _, window in ipairs(windows) do
    local phase = window.phase + 128 * held_us
    window.number = window.number + phase // window.length_us
    window.phase = phase % window.length_us
  end
  since_high_us = since_high_us and later(since_high_us, held_us)
  unknown_us = unknown_us and later(unknown_us, held_us)
  doubt_us = doubt_us and later(doubt_us, held_us)
  flown_us = flown_us and later(flown_us, held_us)
  read_commands()
  if not vehicle:get_likely_flying() or rests() then
    value = {}
    if flown_us then
      down_us = down_us and later(down_us, held_us) or 0
      if down_us >= 1000000 then
        forget(false)
      end
    else
      -- It landed in a gap.
      doubt_us = nil
      forget_trims()
    end
    return nil
  end
  down_us = nil
  flown_us = flown_us or 0
  observe()
  settle()
  if settled then
    notice()
  end
  local is_known = read_inputs()
  -- While the command of a motor is unknown, so is the risk.
  is_known = is_known and sum
  local risk = is_known and estimate()
  if not risk then
    if unknown_us and unknown_us > 2000000 then
      doubt_us = level_now() > 0 and unknown_us or nil
      stop_judging()
      unknown_us = nil
    end
    return nil
  end
  unknown_us = 0
  if warn_risk and risk >= warn_risk then
    since_high_us = 0
  end
  add_up(risk)
  judge(risk, flown_us < 3000000)
  return risk
end
-- The calls.

local is_enabled = true
local last_call -- the autopilot's clock
local sent_us, logged_bin, settings_us = 1000000000, -1, 0
local has_failed = false

-- FRISK_ENABLE = 0 silences the script.
local function read_parameters()
  local enable = param:get("FRISK_ENABLE")
  is_enabled = enable == nil or enable > 0
  warn_risk = param:get("FRISK_WARN") or 66.0
  fail_risk = param:get("FRISK_FAIL") or 80.0
end

local function update()
  local now = micros()
  held_us = last_call and (now - last_call):toint() or 0
  if held_us < 0 or held_us > 1000000000 then
    held_us = 1000000000
  end
  if not last_call then
    read_parameters()
  elseif held_us == 0 then
    return
  end
  last_call = now
  held_s = held_us * 1e-6
  -- Limits and parameters may change on the ground.
  settings_us = later(settings_us, held_us)
  if not flown_us and settings_us >= 1000000 then
    settings_us = 0
    read_parameters()
    read_limits()
  end
  if not is_enabled then
    return
  end
  local before = level_now()
  local risk = fly()
  local level = level_now()
  if level ~= before and flown_us and not down_us then
    say(level, risk, false)
  end
  -- What is raised where the level stands already is told, too.
  if raised and level == before and flown_us and not down_us then
    say(level, risk, true)
  end
  raised = false
  sent_us = later(sent_us, held_us)
  if risk and sent_us >= 500000 then
    sent_us = 0
    gcs:send_named_float("FR_RISK", risk)
    gcs:send_named_float("FR_ELEV", elevated)
  end
  if risk and logged_bin ~= bin then
    logged_bin = bin
    logger:write("FRSK", "Risk,Elev,Level", "ffB", risk, elevated, level)
  end
end

-- An error that leaves a script stops it and blocks arming.
function protected()
  local is_well, told = pcall(update)
  if is_well then
    return protected, 30
  end
  if not has_failed then
    has_failed = true
    gcs:send_text(3, sub("FLAGRED failed: " .. tostring(told), 1, 50))
  end
  pcall(forget)
  return protected, 1000
end

-- The first call, when the memory of the loader is free again. What calls take for a moment must be left.
function begin()
  begin = nil
  if not pcall(rep, " ", 3000) then
    gcs:send_text(3, "FLAGRED is off: increase SCR_HEAP_SIZE")
    return
  end
  gcs:send_text(6, format("FLAGRED: %d motors, %.0f to %.0f us", motors, read_limits()))
  return protected, 30
end
-- The elevated risk: what the risks of the last seconds add up to. Its window is `risks`, with one row.

elevated = 0.0
local last_risk, last_rate

function clear_elevated()
  clear(risks)
  elevated, last_risk, last_rate = 0.0, nil, nil
end

-- Abramowitz and Stegun 7.1.26, right to 1.5e-7.
local function erf(x)
  local t = 1 / (1 + 0.3275911 * abs(x))
  local y = 1 - ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t * exp(-x * x)
  return x < 0 and -y or y
end

-- The share of a normal distribution below x.
local function share_below(x, mean, deviation)
  local distance = x - mean
  if deviation > 0 then
    return 0.5 * (1 + erf(distance / deviation * 0.70710678))
  end
  return distance == 0 and 0.5 or distance > 0 and 1.0 or 0.0
end

function add_up(risk)
  local before, row = last_risk or risk, risks.rows[1]
  row.x, row.within = 0.5 * (before + risk), (risk - before) * (risk - before) / 12
  take_sample(risks, held_s)
  local out = outside(risks)
  local total = total_of(risks, risks.weight, out)
  if total > 0 then
    local mean, variance = read_row(risks, row, total, out)
    local deviation = sqrt(variance)
    local rate = 0.7 * (1 - share_below(52.0, mean, deviation)) - 1.4 * share_below(35.0, mean, deviation)
    elevated = elevated + 0.5 * (rate + (last_rate or rate)) * held_s
    elevated = max(0.0, min(100.0, elevated))
    last_risk, last_rate = risk, rate
  end
end
-- What the pilot reads, in at most 50 characters.

function level_now()
  local level = risk_level
  level = little_reserve and max(level, 2) or level
  level = (imbalance or weak) and max(level, 2) or level
  return doubt_us and max(level, 2) or level
end

-- A cause in two parts; where there is no room for the last one, the first one is true alone.
function cause_in_words()
  local about = cause and CAUSES[cause]
  if not about then
    return ", interpolated", ""
  end
  if limit_motor then
    local side = is_upper[limit_motor] and "upper" or "lower"
    return ", " .. side .. " limit", format(", motor %d", numbers[limit_motor])
  end
  return ", " .. about[3], " " .. about[4]
end

local LEVELS = {[0] = "GOOD", [2] = "WARN", [3] = "FAIL"}

function say(level, risk, of_notice)
  local severity = level == 3 and 2 or level == 2 and 4 or 6
  local text = "FLAGRED: " .. LEVELS[level]
  if (of_notice or not is_open) and weak then
    text = format("%s motor %d", text, numbers[weak_motor])
    text = or_weak and format("%s or %d", text, numbers[or_weak]) or text
    gcs:send_text(severity, format("%s weak: +%.0f %%", text, weak))
    return
  end
  if (of_notice or not is_open) and imbalance then
    text = format("%s %s %.0f %%, motor %d", text, imbalance_words, imbalance, numbers[unbalanced])
    gcs:send_text(severity, text .. (or_unbalanced and format(" or %d", numbers[or_unbalanced]) or ""))
    return
  end
  if (of_notice or not is_open) and little_reserve then
    gcs:send_text(severity, format("%s reserve %.0f %%", text, little_reserve))
    return
  end
  if not is_open and level > 0 then
    gcs:send_text(severity, text .. " stands: motors not as before")
    return
  end
  if is_open and by_elevated then
    text = format("%s elevated %.0f %%", text, elevated)
  elseif risk then
    text = format("%s risk %.0f %%", text, risk)
  end
  if is_open then
    local first, second = cause_in_words()
    text = #text + #first <= 50 and text .. first or text
    text = #text + #second <= 50 and text .. second or text
  end
  gcs:send_text(severity, text)
end

]==]
