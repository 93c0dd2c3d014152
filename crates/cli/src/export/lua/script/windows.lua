-- Windows: sums over the last seconds, in slots of time that merge samples. The slots form a ring with three parts. In the front,
-- each slot contains the sum of itself and all later slots of the front. The middle is converted to the same form, two slots per
-- call. New slots are added to the back. Thus the cost of a call does not depend on the length of the window, and rounding errors
-- do not accumulate, because nothing is subtracted from a sum that is kept.

function clear(window)
  window.slots, window.front, window.middle, window.back, window.unturned = 0, 0, 0, 0, 0
  window.oldest, window.newest, window.samples, window.is_full = 1, 0, 0, false
  window.bin_samples, window.bin_held = 0, 0.0
  for _, list in ipairs(window.lists) do
    list.middle, list.back = NONE, NONE
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
    list.middle, list.back = list.back, NONE
  end
end

-- Converts up to `count` slots of the middle, so that each contains the sum of itself and the later ones.
local function sum_middle(window, count)
  while count > 0 and window.unturned > 0 do
    local later_slot = window.turning
    local slot = (later_slot - 2) % window.capacity + 1
    for _, list in ipairs(window.lists) do
-- @if extremes
      local pick = list.pick
      list[slot] = pick and pick(list[slot], list[later_slot]) or list[slot] + list[later_slot]
-- @else
      list[slot] = list[slot] + list[later_slot]
-- @end
    end
    window.turning, window.unturned, count = slot, window.unturned - 1, count - 1
  end
end

-- If the front is empty, the middle becomes the front.
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
    list.middle = NONE
  end
end

-- Drops slots that ended at least this long ago.
function drop_older(window, us)
  while window.slots > 0 and clock_us - window.end_us[window.oldest] >= us do
    keep_a_front(window)
    window.oldest = window.oldest % window.capacity + 1
    window.front, window.slots = window.front - 1, window.slots - 1
    -- At least one sample per slot is left; the exact number is not stored.
    window.samples = window.slots
  end
end

-- The slot for a sample that ended at `end_us`: the newest slot if it has this number or the ring is full, otherwise a new one.
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
      list[window.newest] = NONE
    end
  end
  sum_middle(window, 2)
  window.end_us[window.newest] = end_us
  window.samples = window.samples + 1
  return window.newest
end

local function put(list, slot, x)
-- @if extremes
  local pick = list.pick
  if pick then
    list[slot], list.back = pick(list[slot], x), pick(list.back, x)
    return
  end
-- @end
  list[slot], list.back = list[slot] + x, list.back + x
end

-- Adds a value to a slot. The sums of a spread are relative to a value near the mean, which preserves their precision.
local function merge(row, slot, held, x, rest)
-- @if extremes
  if row.kind == "lowest" or row.kind == "highest" then
    put(row.sum, slot, x)
    return
  end
-- @end
  if row.kind == "mean" then
    put(row.sum, slot, held * x)
  else
    row.shift = row.shift or x
    local d = x - row.shift
    put(row.sum, slot, held * d)
    put(row.square, slot, held * (d * d + rest))
  end
end

-- The value of the latest bin, and a second number: for a mean, the squared step from the bin before, whose mean is computed;
-- for a spread, minus half of that squared step, which removes the noise from the variance.
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

-- The sum of a list, without the share `out` of its oldest slot.
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

-- Changes the value that the sums of a row are relative to.
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

-- The mean, the lowest or the highest value of a row; for a spread, the mean and the variance.
function read_row(window, row, total, out)
  local kind, held = row.kind, window.bin_held
-- @if extremes
  if kind == "lowest" or kind == "highest" then
    local list = row.sum
    local found = list.pick(list.middle, list.back)
    return window.front > 0 and list.pick(found, list[window.oldest]) or found
  end
-- @end
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
