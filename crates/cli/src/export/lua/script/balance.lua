-- The balance of the motors: a motor that works harder than before, and whether all work as before.

local lately, trims, shifts = {}, {}, {} -- of each motor
at_zero = {} -- how long each motor has been at zero, in s
local lately_s, trim_s, load, load_s = 0.0, 0.0, 0.0, 0.0
local imbalance_us, weak_us -- for how long the limits have been exceeded
imbalance, imbalance_words = nil, nil -- the imbalance in %, and its kind
unbalanced, or_unbalanced = nil, nil -- the unbalanced motor, and a second one that may be it instead
weak, weak_motor, or_weak = nil, nil, nil -- the extra command of a weak motor in %, the motor, and a second one that may be it
sinks = false
local ok = false

-- The weight of this call in an average.
local function weight(known_s, constant_s)
  return held_s / max(min(known_s, constant_s), held_s)
end

-- Whether the commands of the motors differ no more than in the last seconds. In a fall they differ more.
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

-- The motor to name, and a second one if the numbers do not show which of the two it is. It is the highest one if that is well
-- above the others; otherwise the one that stopped first; if none stopped, the highest one.
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

-- The yaw effort of a list with a number for each motor.
local function yaw_of(list)
  local yaw = 0.0
  if has_geometry then
    for i = 1, motors do
      yaw = yaw + yaw_share[i] * list[i]
    end
  end
  return yaw
end

-- The largest amount by which a motor exceeds the opposite one, except for the part due to yaw.
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
  if risk_level == GOOD and not ok_us and (not learned or settled and is_near(lately, trims, IMBALANCE_ABOVE / 2)) then
    learn_trims(mean)
  end
  ok = settled and (learned and is_near(lately, trims, IMBALANCE_ABOVE / 2) or not learned and is_near(lately, nil, IMBALANCE_ABOVE))
  local squares = 0.0
  for i = 1, motors do
    shifts[i] = lately[i] - trims[i]
    squares = squares + shifts[i] * shifts[i]
  end
  local first, second = two_highest(shifts)
  local shift = shifts[first]
  local is_known = learned and settled
  if is_known and shift > IMBALANCE_ABOVE / 2 and shift * shift >= 0.75 * (min(motors - 1.0, 3.0) / motors) * squares then
    imbalance_us = nil
    weak_us = weak_us and later(weak_us, held_us) or 0
    if weak then
      weak = max(weak, 100 * shift)
    elseif weak_us >= IMBALANCE_AFTER_US then
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
  if most <= IMBALANCE_ABOVE or not is_known then
    words, list, most = "pair imbalance", lately, settled and at_odds() / 2 or 0.0
  end
  if most <= IMBALANCE_ABOVE or weak then
    imbalance_us = nil
    return
  end
  if list == lately then
    most = 2 * most
  end
  imbalance_us = imbalance_us and later(imbalance_us, held_us) or 0
  if imbalance then
    imbalance = words == imbalance_words and max(imbalance, 100 * most) or imbalance
  elseif imbalance_us >= IMBALANCE_AFTER_US then
    imbalance, imbalance_words, raised = 100 * most, words, true
    unbalanced, or_unbalanced = culprit(list)
  end
end

-- Whether all motors work as before the alarm; if no trims were learned before it, whether all motors work alike.
function works_as_before()
  return ok
end

-- Forgets the trims, because a new flight may begin.
function forget_trims()
  if trim_s > 0 then
    trims, trim_s = {}, 0.0
  end
end

function forget_balance()
  lately, at_zero, lately_s, load, load_s = {}, {}, 0.0, 0.0, 0.0
  imbalance_us, weak_us, imbalance, weak, sinks, ok = nil, nil, nil, nil, false, false
end
