-- @put heading
--
-- Put it into APM/scripts on the card. It reads the motor outputs and says how close the vehicle is to losing control:
-- FR_RISK and FR_ELEV in %, and a text when the level changes. It changes nothing on the vehicle. How to install it, what it
-- costs and how it was tested: docs/on-ardupilot.md of FLAGRED.

local CALL_MS = 30 -- between two calls
local SEND_US = 500000 -- between two values for the ground station
local BIN_US = 100000 -- of commands that are averaged before their noise is taken out
local SLOTS = 128 -- of a window
local LONG_US = 1000000000 -- longer times are this long
local CRITICAL, ERROR, WARNING, INFO = 2, 3, 4, 6 -- severities of MAVLink
local GOOD, WARN, FAIL = 0, 2, 3 -- levels
local LEVELS = {[GOOD] = "GOOD", [WARN] = "WARN", [FAIL] = "FAIL"}
local floor, sqrt, exp, huge, min, max = math.floor, math.sqrt, math.exp, math.huge, math.min, math.max

-- The profile.
-- @put settings

---------------------------------------------------------------------------------------------------------------------------
-- The parameters of this script. FRISK_ENABLE = 0 silences it.

local is_enabled = true

local function read_parameters()
  local enable = param:get("FRISK_ENABLE")
  is_enabled = enable == nil or enable > 0
-- @if warn_risk
  WARN_RISK = param:get("FRISK_WARN") or WARN_RISK
  WARN_UNTIL_RISK = WARN_UNTIL_RISK and min(WARN_UNTIL_RISK, WARN_RISK)
-- @end
-- @if fail_risk
  FAIL_RISK = param:get("FRISK_FAIL") or FAIL_RISK
  FAIL_UNTIL_RISK = FAIL_UNTIL_RISK and min(FAIL_UNTIL_RISK, FAIL_RISK)
-- @end
end

---------------------------------------------------------------------------------------------------------------------------
-- Time. Whole microseconds that wrap after 71 min; only differences of under 35 min are used.

local last_call -- the autopilot's clock
local clock_us = 0
local held_us, held_s = 0, 0.0 -- since the last call
local bin, bin_us = 0, 0 -- the bin of commands, and the time into it
local has_moved = false -- whether this call has done one of the longer works

local function later(us, by_us)
  return us < LONG_US and us + by_us or us
end

---------------------------------------------------------------------------------------------------------------------------
-- Motors. A command is 0 at the lower limit of the range that is used in flight, 1 at the upper one.

local motors = 0
local functions, numbers = {}, {} -- of the outputs
local low_us, scale = 1000.0, 0.001
local command, sum = {}, nil -- the sum is nil where the commands are unknown
-- @if less_yaw
local less_yaw = {} -- the same without the part that turns the nose
-- @end
-- @if margin
local margin = {} -- how far each motor is from its nearer limit
-- @end
-- @if high_side
local high_side = {} -- how far each motor is from its upper limit
-- @end
-- @if noise
local bin_sum, bin_before, bin_count, noise_bin, command_noise = {}, {}, 0, nil, nil
-- @end
-- @if geometry
local yaw_factor, has_geometry = {}, false
-- @if imbalance
local opposite = {} -- the motor on the other side; nil where there is none
-- @end
-- @put efforts
-- @end

local function pair(low, high, least, most, width)
  low, high = low and param:get(low), high and param:get(high)
  if low and high and low >= least and high <= most and high - low >= width then
    return low, high
  end
end

-- MOT_PWM_MIN and MAX, or the range of the throttle's channel, and of it MOT_SPIN_MIN to MAX. False where they are no limits.
local function read_limits()
  local own = param:get("MOT_PWM_MIN")
  local low, high
  if own and own > 0 then
    low, high = pair("MOT_PWM_MIN", "MOT_PWM_MAX", 500, 2500, 100)
  else
    local channel = string.format("RC%.0f_", param:get("RCMAP_THROTTLE") or 3)
    low, high = pair(channel .. "MIN", channel .. "MAX", 500, 2500, 100)
  end
  if not low then
    return false
  end
  local spin_low, spin_high = pair("MOT_SPIN_MIN", "MOT_SPIN_MAX", 0, 1, 0.1)
  spin_low, spin_high = spin_low or 0, spin_high or 1
  low_us = low + spin_low * (high - low)
  scale = 1 / ((spin_high - spin_low) * (high - low))
  return true
end

local function read_commands()
  local total = 0.0
-- @put clear_efforts
  for i = 1, motors do
    local pwm = SRV_Channels:get_output_pwm(functions[i])
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
-- @if less_yaw
  for i = 1, motors do
    less_yaw[i] = has_geometry and command[i] - yaw_factor[i] * yaw_effort or command[i]
  end
-- @end
end
-- @if deviation_of

local function deviation_of(list)
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
-- @end
-- @if highest_of

local function highest_of(list)
  return max(table.unpack(list, 1, motors))
end
-- @end
-- @if lowest_of

local function lowest_of(list)
  return min(table.unpack(list, 1, motors))
end
-- @end
-- @if mean_of

local function mean_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i]
  end
  return total / motors
end
-- @end
-- @if mean_square_of

local function mean_square_of(list)
  local total = 0.0
  for i = 1, motors do
    total = total + list[i] * list[i]
  end
  return total / motors
end
-- @end
-- @if share_of_above

local function share_of_above(list, limit)
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

local function share_of_below(list, limit)
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

-- The noise of the commands, known when a bin is complete: of the steps between the means of bins.
local function take_noise()
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

local function forget_noise()
  bin_sum, bin_before, bin_count, noise_bin = {}, {}, 0, nil
end
-- @end

---------------------------------------------------------------------------------------------------------------------------
-- Windows: sums over the last seconds, in slots of time in which samples are merged. The slots lie in a ring, in three runs: the
-- front, of whose slots each holds the sum of itself and the later ones of the front; the middle, which is made the same, two
-- slots a call; and the back, to which slots are added. So a call costs the same whatever the length, and as nothing is
-- subtracted from a sum that stays, nothing drifts.

local windows = {}

local FREE = {}
for slot = 1, SLOTS + 2 do
  FREE[slot] = 0
end

-- A list of numbers, one for each slot, of which `pick` gives the smaller or larger; without it they add up.
local function new_list(window, pick, none)
  local list = {table.unpack(FREE, 1, window.capacity)}
  list.pick, list.none, list.middle, list.back = pick, none, none, none
  window.lists[#window.lists + 1] = list
  return list
end

-- `capacity` is the most slots in use at once.
local function new_window(length_s, capacity, in_bins)
  local window = {
    length_us = floor(length_s * 1000000), needed_s = 0.99 * min(WARM_UP_US * 1e-6, length_s), capacity = capacity,
    number = 0, phase = 0, -- the slot of the present, and 128 times the time into it
    oldest = 1, newest = 0, newest_number = nil, slots = 0, front = 0, middle = 0, back = 0, turning = 0, unturned = 0,
    samples = 0, start_us = 0, back_since_us = 0, is_full = false,
    end_us = {table.unpack(FREE, 1, capacity)}, lists = {}, rows = {},
    bin = 0, bin_samples = 0, bin_held = 0.0, bin_end_us = 0, bin_number = 0, -- the latest bin, not in a slot yet
  }
  window.weight = new_list(window, nil, 0.0)
  windows[#windows + 1] = window
  return window
end

-- Something to know of a window: a "mean", a "spread" about the mean, the "lowest" or the "highest" value. `x` is the value
-- of a sample, nil where it is unknown, and `within` the variance that one sample has in itself.
local function new_row(window, kind)
  local row = {window = window, kind = kind, x = nil, within = 0.0, shift = nil, bin_sum = 0.0, before = nil}
  if kind == "lowest" then
    row.sum = new_list(window, min, huge)
  elseif kind == "highest" then
    row.sum = new_list(window, max, -huge)
  else
    row.sum = new_list(window, nil, 0.0)
    row.square = kind == "spread" and new_list(window, nil, 0.0) or nil
  end
  window.rows[#window.rows + 1] = row
  return row
end

local function clear(window)
  window.slots, window.front, window.middle, window.back, window.unturned = 0, 0, 0, 0, 0
  window.oldest, window.newest, window.samples, window.is_full = 1, 0, 0, false
  window.bin_samples, window.bin_held = 0, 0.0
  for _, list in ipairs(window.lists) do
    list.middle, list.back = list.none, list.none
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
    list.middle, list.back = list.back, list.none
  end
end

-- Makes slots of the middle hold the sum of themselves and the later ones.
local function sum_middle(window, count)
  while count > 0 and window.unturned > 0 do
    local later_slot = window.turning
    local slot = (later_slot - 2) % window.capacity + 1
    for _, list in ipairs(window.lists) do
      local pick = list.pick
      list[slot] = pick and pick(list[slot], list[later_slot]) or list[slot] + list[later_slot]
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
  sum_middle(window, SLOTS + 2)
  window.front, window.middle = window.middle, 0
  for _, list in ipairs(window.lists) do
    list.middle = list.none
  end
end

-- Drops what ended so long ago or longer.
local function drop_older(window, us)
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
      list[window.newest] = list.none
    end
  end
  sum_middle(window, 2)
  window.end_us[window.newest] = end_us
  window.samples = window.samples + 1
  return window.newest
end

local function put(list, slot, x)
  local pick = list.pick
  if pick then
    list[slot], list.back = pick(list[slot], x), pick(list.back, x)
  else
    list[slot], list.back = list[slot] + x, list.back + x
  end
end

-- Puts a value into a slot. Spreads are sums about a value near the mean, which keeps their digits.
local function merge(row, slot, held, x, rest)
  if row.kind == "mean" then
    put(row.sum, slot, held * x)
  elseif row.kind == "spread" then
    row.shift = row.shift or x
    local d = x - row.shift
    put(row.sum, slot, held * d)
    put(row.square, slot, held * (d * d + rest))
  else
    put(row.sum, slot, x)
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

local function take_bin(window)
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

local function take_sample(window, held)
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
local function total_of(window, list, out)
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
local function outside(window)
  if not window.is_full and clock_us - window.start_us < window.length_us - BIN_US or window.slots == 0 then
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
    square[slot] = square[slot] + by * (by * weight[slot] - 2 * sum[slot])
    sum[slot] = sum[slot] - by * weight[slot]
  end
  for _, run in ipairs({"middle", "back"}) do
    square[run] = square[run] + by * (by * weight[run] - 2 * sum[run])
    sum[run] = sum[run] - by * weight[run]
  end
  row.shift = row.shift + by
end

-- The mean, the lowest or the highest value; for a spread the mean and the variance.
local function read_row(row, total, out)
  local window, kind = row.window, row.kind
  local held = window.bin_held
  if kind == "lowest" or kind == "highest" then
    local list = row.sum
    local found = list.pick(list.middle, list.back)
    return window.front > 0 and list.pick(found, list[window.oldest]) or found
  end
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

---------------------------------------------------------------------------------------------------------------------------
-- The inputs of the rules.

local inputs, value = {}, {} -- their rows; their values, nil where one is unknown
-- @put inputs

-- Takes in a sample of flight.
local function observe()
-- @put observe
end

-- The seconds that are known of a window and the share of its oldest slot that has left it; nil where too little is known.
local function enough(window)
  local out = outside(window)
  local total = total_of(window, window.weight, out) + window.bin_held
  local samples = window.samples + (window.bin_held > 0 and 1 or 0)
  if total < window.needed_s or total <= 0 or samples < MIN_SAMPLES then
    return nil
  end
  return total, out
end

local function deviation(row, total, out)
  local _, variance = read_row(row, total, out)
  return sqrt(variance)
end

-- The inputs' values; false where one is not known.
local function read_inputs()
  local all, total, out = true, nil, nil
-- @put read_inputs
  return all
end

---------------------------------------------------------------------------------------------------------------------------
-- The rules.

local fired, coverage = {}, 0.0 -- the firing strengths of rules, and the largest
local by_rules -- the risk by the rules in %; nil where none fires
do

local strengths, degrees = {}, {} -- of output terms, and of terms of inputs

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
  if strength < LEAST_STRENGTH then
    strength = 0.0
  end
  fired[rule] = strength
-- @if sums
  strengths[term] = strengths[term] + strength
-- @else
  if strength > strengths[term] then
    strengths[term] = strength
  end
-- @end
  if strength > coverage then
    coverage = strength
  end
end
-- @put operators

-- @put terms

by_rules = function(x)
  coverage = 0.0
  for term = 1, OUTPUT_TERMS do
    strengths[term] = 0.0
  end
-- @put rules
-- @put defuzzify
end

end
-- @if filled

-- Where the rules leave a gap: values at knots, the last input running fastest; linear between them.
local filled
do

local KNOTS = {
-- @put knots
}
local FILLED = {
-- @put filled
}

filled = function(x, axis, knot)
  local places = KNOTS[axis]
  if not places then
    return FILLED[knot + 1]
  end
  local count, behind = #places, 0
  while behind < count and places[behind + 1] <= x[axis] do
    behind = behind + 1
  end
  local first = knot * count
  if behind == 0 or behind == count then
    return filled(x, axis + 1, first + (behind == 0 and 0 or count - 1))
  end
  local left = places[behind]
  local share = (x[axis] - left) / (places[behind + 1] - left)
  local low = filled(x, axis + 1, first + behind - 1)
  if share == 0 then
    return low
  end
  return (1 - share) * low + share * filled(x, axis + 1, first + behind)
end

end
-- @end

local point = {} -- the inputs of the rules, in their order
local is_filled = false

local function estimate()
-- @put point
  local risk = by_rules(point)
-- @if filled
  -- A coverage a hair below the limit is rounding.
  is_filled = coverage < COVERAGE_BELOW * (1 - 1e-5)
  if is_filled then
    risk = filled(point, 1, 0)
  end
-- @end
  return risk and max(0.0, min(100.0, risk))
end

---------------------------------------------------------------------------------------------------------------------------
-- The elevated risk: what the risks of the last seconds add up to.

local risks = new_window(ELEVATED_WINDOW_S, min(SLOTS + 2, floor(ELEVATED_WINDOW_S * 1000 / CALL_MS) + 4), false)
local elevated, last_risk, last_rate = 0.0, nil, nil

local function clear_elevated()
  clear(risks)
  elevated, last_risk, last_rate = 0.0, nil, nil
end

local add_up
do

local risk_row = new_row(risks, "spread")

-- Abramowitz and Stegun 7.1.26, right to 1.5e-7.
local function erf(x)
  local t = 1 / (1 + 0.3275911 * math.abs(x))
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

add_up = function(risk)
  local before = last_risk or risk
  risk_row.x, risk_row.within = 0.5 * (before + risk), (risk - before) * (risk - before) / 12
  take_sample(risks, held_s)
  local out = outside(risks)
  local total = total_of(risks, risks.weight, out)
  if total > 0 then
    local mean, variance = read_row(risk_row, total, out)
    local deviation = sqrt(variance)
    local rate = RISE * (1 - share_below(ELEVATED_HIGH, mean, deviation)) - FALL * share_below(ELEVATED_LOW, mean, deviation)
    elevated = elevated + 0.5 * (rate + (last_rate or rate)) * held_s
    elevated = max(0.0, min(100.0, elevated))
    last_risk, last_rate = risk, rate
  end
end

end

---------------------------------------------------------------------------------------------------------------------------
-- Levels: raised after a while, held, lowered after a while.

-- What each rule is about: the area and the centre of its consequent, an input and a term, whether motors are at a limit.
local CAUSES = {
-- @put causes
}
local risk_level = GOOD -- of the risk alone
local reached_at = {} -- since when the thresholds of each level are reached
local held_at = 0 -- when something last held the level
local is_open, open_level, by_elevated, cause = false, GOOD, false, nil -- the time of trouble
-- @if motor_cause
local seen, mean_margin, least_margin, is_upper = 0, {}, {}, {} -- the motors while a level is being reached
local limit_motor = nil -- the motor that is nearest to a limit, where that is the cause
-- @end

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

-- @if motor_cause
-- The motor with the least mean margin, where it is near a limit.
local function weakest()
  local found
  for i = 1, motors do
    if mean_margin[i] and (not found or mean_margin[i] < mean_margin[found]) then
      found = i
    end
  end
  return found and least_margin[found] < 0.1 and found or nil
end

-- @end
local function raise(level, of_elevated, risk)
  risk_level = level
  if not is_open or open_level ~= level then
    by_elevated = of_elevated
  end
  if not is_open or level > open_level then
    cause, open_level = find_cause(risk), level
-- @if motor_cause
    limit_motor = cause and CAUSES[cause][5] and weakest()
-- @end
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
-- @if motor_cause

-- Keeps what the motors do while a level is being reached, from its beginning.
local function watch_motors(risk, takes_off)
  local warns = not takes_off and is_reached(risk, WARN_RISK, WARN_ELEVATED)
  local fails = is_reached(risk, FAIL_RISK, FAIL_ELEVATED)
  if not warns and not fails then
    return
  end
  if warns and not reached_at[WARN] or fails and not reached_at[FAIL] then
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
-- @end

local function judge(risk, takes_off)
-- @if motor_cause
  watch_motors(risk, takes_off)
-- @end
  local held = GOOD
  held = follow(WARN, held, risk, not takes_off, WARN_RISK, WARN_ELEVATED, WARN_AFTER_US, WARN_UNTIL_RISK, WARN_UNTIL_ELEVATED)
  held = follow(FAIL, held, risk, true, FAIL_RISK, FAIL_ELEVATED, FAIL_AFTER_US, FAIL_UNTIL_RISK, FAIL_UNTIL_ELEVATED)
  if held >= risk_level then
    held_at = clock_us
  elseif clock_us - held_at >= CLEAR_AFTER_US then
    risk_level, held_at = held, clock_us
    is_open = held > GOOD
  end
end

local function stop_judging()
  clear_elevated()
  risk_level, is_open = GOOD, false
  reached_at[WARN], reached_at[FAIL] = nil, nil
end
-- @if notices

---------------------------------------------------------------------------------------------------------------------------
-- What is told beside the risk, as WARN until the flight ends.

local raised = false -- whether something was raised in this call

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
-- @if reserve

local reserve, reserve_us, little_reserve = new_average(), nil, nil

local function watch_reserve(mean)
  average(reserve, 1 - mean, 3.0)
  if reserve.known < 3.0 or reserve.value >= RESERVE_BELOW then
    reserve_us = nil
    return
  end
  reserve_us = reserve_us and later(reserve_us, held_us) or 0
  if not little_reserve and reserve_us >= RESERVE_AFTER_US then
    raised = true
  end
  if little_reserve or raised then
    little_reserve = min(little_reserve or huge, 100 * reserve.value)
  end
end
-- @end
-- @if imbalance

local difference, trim = {}, {} -- of each motor from the mean of all, lately and as a trim
local settled_us, imbalance_us, imbalance, unbalanced, of_pair = nil, nil, nil, nil, false

-- How far a motor is above the one opposite at most, and that motor: a fault from before the trim was learned shows only here.
local function at_odds()
  local most, motor = 0.0, nil
  for i = 1, motors do
    local other = difference[opposite[i]]
    if other and difference[i].known >= 5.0 then
      local above = difference[i].value - other.value
      if not motor or above >= most then
        most, motor = above, i
      end
    end
  end
  return most, motor
end

local function watch_balance(mean)
  settled_us = settled_us and later(settled_us, held_us) or 0
  local most, motor = 0.0, nil
  for i = 1, motors do
    local now, usual = difference[i], trim[i]
    if not now then
      now, usual = new_average(), new_average()
      difference[i], trim[i] = now, usual
    end
    local x = less_yaw[i] - mean
    average(now, x, 5.0)
    local from_trim = now.value - usual.value
    if usual.known < 10.0 or math.abs(from_trim) < IMBALANCE_ABOVE / 2 then
      average(usual, x, 30.0)
    end
    if not motor or math.abs(from_trim) > most then
      most, motor = math.abs(from_trim), i
    end
  end
  local limit, is_pair = IMBALANCE_ABOVE, false
  if most <= limit or settled_us < 10000000 then
    most, motor = at_odds()
    limit, is_pair = 2 * IMBALANCE_ABOVE, true
  end
  if most <= limit then
    imbalance_us = nil
    return
  end
  imbalance_us = imbalance_us and later(imbalance_us, held_us) or 0
  if imbalance then
    imbalance = is_pair == of_pair and max(imbalance, 100 * most) or imbalance
  elseif imbalance_us >= IMBALANCE_AFTER_US then
    imbalance, unbalanced, of_pair, raised = 100 * most, motor, is_pair, true
  end
end
-- @end

local function notice()
  raised = false
  if not sum then
    return
  end
-- @if reserve
  watch_reserve(sum / motors)
-- @end
-- @if imbalance
  watch_balance(sum / motors)
-- @end
end

local function forget_notices()
-- @if reserve
  reserve, reserve_us, little_reserve = new_average(), nil, nil
-- @end
-- @if imbalance
  difference, trim = {}, {}
  settled_us, imbalance_us, imbalance, unbalanced, of_pair = nil, nil, nil, nil, false
-- @end
end
-- @end

---------------------------------------------------------------------------------------------------------------------------
-- What the pilot reads, in at most 50 characters.

local function level_now()
  local level = risk_level
-- @if reserve
  level = little_reserve and max(level, WARN) or level
-- @end
-- @if imbalance
  level = imbalance and max(level, WARN) or level
-- @end
  return level
end

-- A cause in two parts; where there is no room for the last one, the first one is true alone.
local function cause_in_words()
  local about = cause and CAUSES[cause]
  if not about then
    return ", interpolated", ""
  end
-- @if motor_cause
  if limit_motor then
    local side = is_upper[limit_motor] and "upper" or "lower"
    return ", " .. side .. " limit", string.format(", motor %d", numbers[limit_motor])
  end
-- @end
  return ", " .. about[3], " " .. about[4]
end

local function say(level, risk, of_notice)
  if level == GOOD and not risk then
    gcs:send_text(INFO, "FLAGRED: risk unknown")
    return
  end
  local severity = level == FAIL and CRITICAL or level == WARN and WARNING or INFO
  local text = "FLAGRED: " .. LEVELS[level]
-- @if imbalance
  if (of_notice or not is_open) and imbalance then
    local kind = of_pair and "pair imbalance" or "imbalance"
    gcs:send_text(severity, string.format("%s %s %.0f %%, motor %d", text, kind, imbalance, numbers[unbalanced]))
    return
  end
-- @end
-- @if reserve
  if (of_notice or not is_open) and little_reserve then
    gcs:send_text(severity, string.format("%s reserve %.0f %%", text, little_reserve))
    return
  end
-- @end
  if is_open and by_elevated then
    text = string.format("%s elevated %.0f %%", text, elevated)
  elseif risk then
    text = string.format("%s risk %.0f %%", text, risk)
  end
  if is_open then
    local first, second = cause_in_words()
    text = #text + #first <= 50 and text .. first or text
    text = #text + #second <= 50 and text .. second or text
  end
  gcs:send_text(severity, text)
end

---------------------------------------------------------------------------------------------------------------------------
-- A flight.

local flown_us -- since take-off; nil on the ground
local down_us -- for how long it seems to be on the ground
local settled, settling = false, huge -- whether the take-off is dropped, and the window to drop it from next
local idle -- "landing" or "trouble"
local since_high_us, unknown_us -- since a high risk, and since a risk was known

local function forget()
  for _, window in ipairs(windows) do
    clear(window)
  end
  flown_us, down_us, settled, settling, idle, since_high_us, unknown_us = nil, nil, false, huge, nil, nil, nil
  value = {}
-- @if notices
  forget_notices()
-- @end
-- @if noise
  forget_noise()
-- @end
  stop_judging()
end

-- Whether the motors idle as on the ground: before take-off, and after a flight that was calm to its end.
local function rests()
  if not sum or sum >= IDLE_BELOW * motors then
    idle = nil
    return false
  end
  if not idle then
    idle = since_high_us and since_high_us <= 2000000 and "trouble" or "landing"
  end
  return idle == "landing"
end

-- Some time after take-off, drops it from the long windows, one a call, and from the elevated risk.
local function settle()
  if not settled and flown_us >= TAKE_OFF_US + WARM_UP_US then
    settled, settling = true, 1
    if TAKE_OFF_US > 0 then
      clear_elevated()
    end
  end
  while TAKE_OFF_US > 0 and settling <= #windows do
    local window = windows[settling]
    settling = settling + 1
    if window.length_us > TAKE_OFF_US then
      drop_older(window, flown_us - TAKE_OFF_US - 1)
      return
    end
  end
end

-- Takes in the time and the motors; gives the risk in %, nil where it is unknown.
local function fly()
  has_moved = false
  clock_us = clock_us + held_us
  bin_us = bin_us + held_us
  bin, bin_us = bin + bin_us // BIN_US, bin_us % BIN_US
  if held_us > LONGEST_GAP_US then
    forget()
    held_us, held_s = 0, 0.0
  end
  for _, window in ipairs(windows) do
    local phase = window.phase + SLOTS * held_us
    window.number = window.number + phase // window.length_us
    window.phase = phase % window.length_us
  end
  since_high_us = since_high_us and later(since_high_us, held_us)
  unknown_us = unknown_us and later(unknown_us, held_us)
  flown_us = flown_us and later(flown_us, held_us)
  read_commands()
-- @if noise
  take_noise()
-- @end
  if not vehicle:get_likely_flying() or rests() then
    value = {}
    if flown_us then
      down_us = down_us and later(down_us, held_us) or 0
      if down_us >= 1000000 then
        forget()
      end
    end
    return nil
  end
  down_us = nil
  flown_us = flown_us or 0
  observe()
  settle()
-- @if notices
  if settled then
    notice()
  end
-- @end
  local risk = read_inputs() and estimate()
  if not risk then
    if unknown_us and unknown_us > LONGEST_GAP_US then
      stop_judging()
      unknown_us = nil
    end
    return nil
  end
  unknown_us = 0
  if WARN_RISK and risk >= WARN_RISK then
    since_high_us = 0
  end
  add_up(risk)
  judge(risk, flown_us < QUIET_US)
  return risk
end

---------------------------------------------------------------------------------------------------------------------------
-- The calls.

local sent_us, logged_bin, settings_us = LONG_US, -1, 0
local has_failed = false

local set_up -- runs once; then its memory is free
do

local PARAMETERS = {
-- @put parameters
}

local function add_parameters()
  local added = param:add_table(PARAMETER_TABLE, "FRISK_", #PARAMETERS)
  for i, parameter in ipairs(PARAMETERS) do
    added = added and param:add_param(PARAMETER_TABLE, i, parameter[1], parameter[2])
  end
  if not added then
    gcs:send_text(WARNING, "FLAGRED: no parameters, the defaults hold")
  end
end
-- @if geometry

-- The frames of ArduPilot: class and type, name, and number, roll, pitch and yaw factor of each motor. One text, since many
-- short ones take more memory to load.
local FRAMES = [[
-- @put frames
]]
-- @end

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
-- @if geometry

-- Solves four equations by elimination with pivots; nil where they do not have one solution.
local function solve(rows, right)
  for step = 1, 4 do
    local pivot = step
    for row = step + 1, 4 do
      if math.abs(rows[row][step]) > math.abs(rows[pivot][step]) then
        pivot = row
      end
    end
    if math.abs(rows[pivot][step]) < 1e-6 then
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

-- @if imbalance
-- The motor on the other side of the middle; of two on one arm the one that turns the same way.
local function find_opposites(factors)
  for i, motor in ipairs(factors) do
    local least = huge
    for other, factor in ipairs(factors) do
      local faces = math.abs(factor[1] + motor[1]) < 0.1 and math.abs(factor[2] + motor[2]) < 0.1
      local is_in_the_middle = math.abs(motor[1]) < 0.1 and math.abs(motor[2]) < 0.1
      local turns = math.abs(factor[3] - motor[3])
      if has_geometry and faces and not is_in_the_middle and turns < least then
        least, opposite[i] = turns, other
      end
    end
  end
end

-- @end
local function read_geometry()
  local class, kind = param:get("FRAME_CLASS"), param:get("FRAME_TYPE")
  local frame = class and kind and string.match("\n" .. FRAMES, string.format("\n%.0f/%.0f [^:]* (%%d+: [^\n]*)", class, kind))
  local factors, known = {}, 0
  for number, roll, pitch, yaw in string.gmatch(frame or "", "(%d+): (%S+) (%S+) (%S+)") do
    known = known + 1
    for i = 1, motors do
      if numbers[i] == tonumber(number) then
        factors[i] = {tonumber(roll) + 0.0, tonumber(pitch) + 0.0, tonumber(yaw) + 0.0, 1.0}
      end
    end
  end
  if #factors ~= motors or known ~= motors then
    gcs:send_text(INFO, "FLAGRED: frame unknown, turning counts")
    return
  end
-- @put read_efforts
-- @put all_efforts
  for i = 1, motors do
    yaw_factor[i] = factors[i][3]
  end
-- @if imbalance
  find_opposites(factors)
-- @end
end
-- @end

set_up = function()
  add_parameters()
  find_motors()
  if not read_limits() then
    motors = 0
  end
-- @if geometry
  read_geometry()
-- @end
  if motors == 0 then
    gcs:send_text(ERROR, "FLAGRED: no motors or no limits, no risk")
    return
  end
  gcs:send_text(INFO, string.format("FLAGRED: %d motors, %.0f to %.0f us", motors, low_us, low_us + 1 / scale))
end

end

local function update()
  if set_up then
    local once = set_up
    set_up = nil
    once()
    read_parameters()
    return
  end
  local now = micros()
  held_us = last_call and (now - last_call):toint() or 0
  if held_us < 0 or held_us > LONG_US then
    held_us = LONG_US
  end
  local is_repeated = last_call and held_us == 0
  last_call = now
  if motors == 0 or is_repeated then
    return
  end
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
-- @if notices
  -- What is raised where the level stands already is told, too.
  if raised and level == before and flown_us and not down_us then
    say(level, risk, true)
  end
  raised = false
-- @end
  sent_us = later(sent_us, held_us)
  if risk and sent_us >= SEND_US then
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
local function protected()
  local is_well, told = pcall(update)
  if is_well then
    return protected, CALL_MS
  end
  if not has_failed then
    has_failed = true
    gcs:send_text(ERROR, string.sub("FLAGRED failed: " .. tostring(told), 1, 50))
  end
  pcall(forget)
  return protected, 1000
end

return protected, 1000
