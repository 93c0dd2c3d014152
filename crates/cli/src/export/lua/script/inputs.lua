-- The inputs of the rules.

value = {} -- the values of the inputs; nil if unknown

-- Adds a sample in flight to the windows.
function observe()
  local inputs, value, windows = inputs, value, windows
-- @put observe
end

-- @if if_missing
has_come = {} -- whether the signals of each input have ever been known: a vehicle may lack them

-- Notes which signals are known, in the air and on the ground.
function note_signals()
-- @put note_signals
end

-- @end
-- The known seconds of a window, and the share of its oldest slot that has left the window; nil if too little is known.
local function enough(window)
  local out = outside(window)
  local total = total_of(window, window.weight, out) + window.bin_held
  local samples = window.samples + (window.bin_held > 0 and 1 or 0)
  if total < window.needed_s or total <= 0 or samples < MIN_SAMPLES then
    return nil
  end
  return total, out
end

-- Computes the inputs. The result is false or nil if an input that the risk depends on is unknown.
function read_inputs()
  local inputs, value, windows = inputs, value, windows
  local all, total, out = true, nil, nil
  local window
-- @put read_inputs
  return all
end
