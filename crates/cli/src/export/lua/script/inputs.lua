-- The inputs of the rules.

value = {} -- of the inputs; nil where one is unknown

-- Takes in a sample of flight.
function observe()
  local inputs, value, windows = inputs, value, windows
-- @put observe
end

-- @if if_missing
has_come = {} -- by input, whether its signals have been known: a vehicle may never send them

-- Notes signals, in the air and on the ground.
function note_signals()
-- @put note_signals
end

-- @end
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

-- The inputs' values; false where one is not known.
function read_inputs()
  local inputs, value, windows = inputs, value, windows
  local all, total, out = true, nil, nil
  local window
-- @put read_inputs
  return all
end
