-- The elevated risk, which accumulates while the risks of the last seconds are high. Its window is `risks`, which has one row.

elevated = 0.0
local last_risk, last_rate

function clear_elevated()
  clear(risks)
  elevated, last_risk, last_rate = 0.0, nil, nil
end

-- Abramowitz and Stegun, formula 7.1.26: the error is at most 1.5e-7.
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
    local rate = RISE * (1 - share_below(ELEVATED_HIGH, mean, deviation)) - FALL * share_below(ELEVATED_LOW, mean, deviation)
    elevated = elevated + 0.5 * (rate + (last_rate or rate)) * held_s
    elevated = max(0.0, min(100.0, elevated))
    last_risk, last_rate = risk, rate
  end
end
