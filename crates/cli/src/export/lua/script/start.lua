-- The windows, made once.

windows, inputs = {}, {} -- each input is a row of a window

local NOTHING = {}

-- A list with a number for each slot; the numbers are added up. It is allocated at its full length, because a table that grows
-- takes twice the memory. A slot that was never used is nil.
-- @if extremes
-- With `pick`, the smallest or largest number is taken instead of the sum; `none` is the number of an empty slot.
local function new_list(window, pick, none)
  local list = {pick = pick, none = none, middle = none, back = none, unpack(NOTHING, 1, window.capacity)}
-- @else
local function new_list(window)
  local list = {middle = 0.0, back = 0.0, unpack(NOTHING, 1, window.capacity)}
-- @end
  window.lists[#window.lists + 1] = list
  return list
end

-- `capacity` is the maximum number of slots in use at once.
local function new_window(length_s, capacity)
  local window = {
    length_us = floor(length_s * 1000000), needed_s = 0.99 * min(WARM_UP_US * 1e-6, length_s), capacity = capacity,
    number = 0, phase = 0, -- the number of the current slot, and 128 times the time since its start
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
-- of a sample, nil if it is unknown, and `within` the variance within that sample.
local function new_row(window, kind)
  local row = {kind = kind, x = nil, within = 0.0, shift = nil, bin_sum = 0.0, before = nil, sum = nil, square = nil}
  row.square = kind == "spread" and new_list(window, nil, 0.0) or nil
-- @if extremes
  if kind == "lowest" then
    row.sum = new_list(window, min, huge)
  elseif kind == "highest" then
    row.sum = new_list(window, max, -huge)
  end
-- @end
  row.sum = row.sum or new_list(window, nil, 0.0)
  window.rows[#window.rows + 1] = row
  return row
end

-- @put inputs
risks = new_window(ELEVATED_WINDOW_S, ELEVATED_CAPACITY)
new_row(risks, "spread")
