-- Parameters and motors, found once.

local PARAMETERS = {
-- @put parameters
}

local function add_parameters()
  local added = param:add_table(PARAMETER_TABLE, "FRISK_", #PARAMETERS)
  for i, parameter in ipairs(PARAMETERS) do
    added = added and param:add_param(PARAMETER_TABLE, i, parameter[1], parameter[2])
  end
  if not added then
    gcs:send_text(WARNING, "FLAGRED: no parameters, defaults are used")
  end
end

local function output(motor_function)
  -- Older firmware has fewer functions, and fails for the others.
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

-- The number of motors of the frame, by FRAME_CLASS; if the class is not in the list, the highest motor number.
local function motors_of_frame()
-- @put motors_of_class
  return MOTORS_OF[param:get("FRAME_CLASS") or 0] or numbers[motors] or 0
end

add_parameters()
find_motors()
local expected = motors_of_frame()
if motors > 0 and motors < expected then
  -- Otherwise the level would be GOOD even if one of the other motors is at a limit.
  error(format("only %d of %d motors have outputs", motors, expected), 0)
end
if motors == 0 or not read_limits() then
  error("no motors or no limits", 0)
end
