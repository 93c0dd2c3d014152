local LEVELS = {[GOOD] = "GOOD", [WARN] = "WARN", [FAIL] = "FAIL"}

function say(level, risk, of_notice)
  local severity = level == FAIL and CRITICAL or level == WARN and WARNING or INFO
  local text = "FLAGRED: " .. LEVELS[level]
-- @if imbalance
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
-- @end
-- @if reserve
  if (of_notice or not is_open) and little_reserve then
    gcs:send_text(severity, format("%s thrust reserve %.0f %%", text, little_reserve))
    return
  end
-- @end
  if is_open and by_fall then
    gcs:send_text(severity, text .. " motors idle in the air")
    return
  end
  if not is_open and level > GOOD then
    gcs:send_text(severity, text .. " stays: motor balance is off")
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
