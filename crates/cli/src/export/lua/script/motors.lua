-- Time, in whole microseconds. It wraps after 71 min, so only differences below 35 min are used.

clock_us = 0
held_us, held_s = 0, 0.0 -- since the last call
bin, bin_us = 0, 0 -- the number of the current bin of commands, and the time since its start
has_moved = false -- whether this call has run `move_shift`, which takes long

function later(us, by_us)
  return us < LONG_US and us + by_us or us
end

-- Motors. A command is 0 at the lower limit of the range that is used in flight, 1 at the upper one.

motors, functions, numbers = 0, {}, {} -- the number of motors; the output function and the motor number of each
command = {}
local low_us, scale = 1000.0, 0.001
-- @if less_yaw
less_yaw = {} -- the commands without the part that turns the nose
-- @end
-- @if margin
margin = {} -- how far each motor is from its nearer limit
-- @end
-- @if high_side
high_side = {} -- how far each motor is from its upper limit
-- @end
-- @if noise
local bin_sum, bin_before, bin_count, noise_bin = {}, {}, 0, nil
-- @end
-- @if geometry
yaw_factor, has_geometry = {}, false
-- @if imbalance
opposite = {} -- the opposite motor of each motor; nil if there is none
-- @end
-- @end

local function pair(low, high, least, most, width)
  low, high = low and param:get(low), high and param:get(high)
  if low and high and low >= least and high <= most and high - low >= width then
    return low, high
  end
end

-- Reads the range from MOT_PWM_MIN and MOT_PWM_MAX or from the throttle channel, and the part of it that MOT_SPIN_MIN and
-- MOT_SPIN_MAX limit. Returns the limits in us; nil if they are not valid.
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

-- Reads the commands. Their sum is nil if one of them is unknown.
function read_commands()
  -- Access to local variables takes fewer instructions.
  local low_us, scale, command, functions, channels = low_us, scale, command, functions, SRV_Channels
-- @if margin
  local margin = margin
-- @end
  local total = 0.0
-- @if geometry
  local has_geometry = has_geometry
-- @end
-- @put clear_efforts
  for i = 1, motors do
    local pwm = channels:get_output_pwm(functions[i])
    if not pwm then
      sum = nil
-- @put forget_efforts
      return
    end
    local e = (pwm - low_us) * scale
    if e < 0 then
      e = 0.0
    elseif e > 1 then
      e = 1.0
    end
    command[i] = e
-- @if margin
    margin[i] = e < 0.5 and e or 1 - e
-- @end
-- @if high_side
    high_side[i] = 1 - e
-- @end
    total = total + e
-- @if geometry
    if has_geometry then
-- @put add_efforts
    end
-- @end
  end
  sum = total
-- @put set_efforts
-- @if less_yaw
  local less_yaw, yaw_factor = less_yaw, yaw_factor
  for i = 1, motors do
    less_yaw[i] = command[i] - (yaw_factor[i] or 0.0) * yaw
  end
-- @end
end
-- @if deviation_of

-- `sum` is the sum of the list; if it is nil, it is computed here.
function deviation_of(list, sum)
  local mean, square = sum or 0.0, 0.0
  for i = 1, sum and 0 or motors do
    mean = mean + list[i]
  end
  mean = mean / motors
  for i = 1, motors do
    local d = list[i] - mean
    square = square + d * d
  end
  return sqrt(square / motors)
end
-- @end
-- @if highest_of

function highest_of(list)
  return max(unpack(list, 1, motors))
end
-- @end
-- @if lowest_of

function lowest_of(list)
  return min(unpack(list, 1, motors))
end
-- @end
-- @if mean_of

function mean_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i]
  end
  return total / motors
end
-- @end
-- @if mean_square_of

function mean_square_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i] * list[i]
  end
  return total / motors
end
-- @end
-- @if share_of_above

function share_of_above(list, limit)
  local count = 0
  for i = 1, motors do
    if list[i] > limit then
      count = count + 1
    end
  end
  return count / motors
end
-- @end
-- @if share_of_below

function share_of_below(list, limit)
  local count = 0
  for i = 1, motors do
    if list[i] < limit then
      count = count + 1
    end
  end
  return count / motors
end
-- @end
-- @if noise

-- Computes the noise of the commands from the steps between the means of bins. It is known only when a bin is complete.
function take_noise()
  command_noise = nil
  if noise_bin ~= bin then
    local squares, known = 0.0, 0
    for i = 1, motors do
      local mean = bin_count > 0 and bin_sum[i] and bin_sum[i] / bin_count or nil
      if mean and bin_before[i] then
        squares, known = squares + (mean - bin_before[i]) * (mean - bin_before[i]), known + 1
      end
      bin_before[i], bin_sum[i] = mean, 0.0
    end
    if known > 0 then
      command_noise = sqrt(squares / known / 2)
    end
    noise_bin, bin_count = bin, 0
  end
  bin_count = bin_count + 1
  for i = 1, motors do
    bin_sum[i] = sum and bin_sum[i] and bin_sum[i] + command[i]
  end
end

function forget_noise()
  bin_sum, bin_before, bin_count, noise_bin = {}, {}, 0, nil
end
-- @end
