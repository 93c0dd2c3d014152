-- Questions to a dataset, for DuckDB. The views `flights` and `findings` come first: see docs/fleet.md.
-- Intervals hold 95 %; those of shares are Wilson's.

-- Ends of Wilson's interval of k of n, in per cent.
CREATE OR REPLACE MACRO wilson_low(k, n) AS
  CASE WHEN k = 0 THEN 0 ELSE 100 * (k + 1.920729 - 1.959964 * sqrt(k * (n - k) / n + 0.960365)) / (n + 3.841459) END;
CREATE OR REPLACE MACRO wilson_high(k, n) AS
  CASE WHEN k = n THEN 100 ELSE 100 * (k + 1.920729 + 1.959964 * sqrt(k * (n - k) / n + 0.960365)) / (n + 3.841459) END;
-- Flights that tell of the risk: judged for at least 10 s.
CREATE OR REPLACE VIEW judged AS FROM flights WHERE status = 'assessed' AND verdict <> 'NA' AND assessed_s >= 10;

-- name: verdicts
-- Shares of the verdicts.
SELECT verdict, count(*) AS flights, 100.0 * count(*) / sum(count(*)) OVER () AS share_pct,
  wilson_low(count(*), sum(count(*)) OVER ()) AS low_pct, wilson_high(count(*), sum(count(*)) OVER ()) AS high_pct,
  sum(in_air_s) / 3600 AS in_air_h
FROM flights WHERE status = 'assessed' GROUP BY verdict
ORDER BY list_position(['FAIL', 'WARN', 'GOOD', 'NA'], verdict);

-- name: weeks
-- The share of flights that warned, and the mean risk, of each week.
SELECT date_trunc('week', start_utc AT TIME ZONE 'UTC')::DATE AS week, count(*) AS flights, 100.0 * count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')) / count(*) AS warned_pct,
  wilson_low(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS low_pct,
  wilson_high(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS high_pct, avg(risk_mean_pct) AS risk_mean_pct
FROM judged WHERE start_utc IS NOT NULL GROUP BY week HAVING count(*) >= 5 ORDER BY week;

-- name: vehicles
-- Each vehicle: how often it warned, its mean risk, and the motor that has the least margin in most flights.
SELECT vehicle, any_value(site) AS site, any_value(pilot) AS pilot, count(*) AS flights, count(DISTINCT start_utc::DATE) AS days,
  count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')) AS warned, count(*) FILTER (WHERE verdict = 'FAIL') AS failed,
  wilson_low(warned, count(*)) AS low_pct, wilson_high(warned, count(*)) AS high_pct, avg(risk_mean_pct) AS risk_mean_pct,
  sum(in_air_s) / 3600 AS in_air_h, mode(weakest_motor) AS weakest_motor, avg(weakest_margin) AS weakest_margin,
  arg_max(firmware, start_utc) AS firmware, min(start_utc) AS first_utc, max(start_utc) AS last_utc
FROM judged WHERE vehicle IS NOT NULL GROUP BY vehicle ORDER BY low_pct DESC, risk_mean_pct DESC, vehicle;

-- name: motors
-- Which motor was at its limit, and at which, in findings that warn.
SELECT motor, side, count(*) AS findings, count(DISTINCT flight_id) AS flights, nullif(count(DISTINCT vehicle), 0) AS vehicles,
  quantile_cont(margin_mean, 0.5) AS margin_median, sum(to_s - from_s) / 60 AS minutes
FROM findings WHERE motor IS NOT NULL AND severity IN ('WARN', 'FAIL') GROUP BY motor, side ORDER BY findings DESC, motor, side;

-- name: causes
-- What happened in findings that warn, and what to do; the text is that of the worst one, without its numbers.
SELECT code, regexp_replace(arg_max(text, value_pct), ' (Motor [0-9]+ was closest to|The (elevated )?risk( `[^`]*`)? reached) .*$', '') AS what,
  arg_max(advice, value_pct) AS advice, count(*) AS findings, 1e2 * count(*) / sum(count(*)) OVER () AS share_pct,
  wilson_low(count(*), sum(count(*)) OVER ()) AS low_pct, wilson_high(count(*), sum(count(*)) OVER ()) AS high_pct,
  count(DISTINCT flight_id) AS flights, count(DISTINCT vehicle) AS vehicles
FROM findings WHERE severity IN ('WARN', 'FAIL') GROUP BY code ORDER BY flights DESC, code LIMIT 20;

-- name: firmware
-- By firmware: the highest risk of a flight, and the share of flights that warned.
SELECT firmware, count(*) AS flights, nullif(count(DISTINCT vehicle), 0) AS vehicles, quantile_cont(risk_max_pct, 0.5) AS risk_max_median_pct,
  quantile_cont(risk_max_pct, 0.95) AS risk_max_p95_pct, 100.0 * count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')) / count(*) AS warned_pct,
  wilson_low(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS low_pct,
  wilson_high(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS high_pct, min(start_utc) AS first_utc
FROM judged GROUP BY firmware ORDER BY flights DESC, firmware LIMIT 30;

-- name: wind
-- By wind, in steps of 3 m/s.
SELECT 3 * least(floor(wind_m_s / 3), 4)::INT AS from_m_s, count(*) AS flights, avg(risk_mean_pct) AS risk_mean_pct,
  100.0 * count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')) / count(*) AS warned_pct,
  wilson_low(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS low_pct,
  wilson_high(count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')), count(*)) AS high_pct
FROM judged WHERE wind_m_s IS NOT NULL GROUP BY from_m_s ORDER BY from_m_s;

-- name: time_at_risk
-- The flights that were longest at a risk that warns.
SELECT log, f.vehicle, start_utc, verdict, at_risk_s, in_air_s FROM flights AS f JOIN (
  SELECT flight_id, sum(to_s - from_s) AS at_risk_s FROM findings
  WHERE measure = 'risk' AND severity IN ('WARN', 'FAIL') GROUP BY flight_id ORDER BY at_risk_s DESC, flight_id LIMIT 100) USING (flight_id)
ORDER BY at_risk_s DESC, log LIMIT 10;

-- name: worst
-- The worst flights, with their gravest finding.
SELECT flight_id, log, f.vehicle, start_utc, verdict, risk_max_pct, elevated_risk_max_pct, firmware, profile, settings, flagred, what, advice
FROM judged AS f LEFT JOIN (
  SELECT flight_id, arg_max(text, (severity = 'FAIL')::INT * 1000 + coalesce(value_pct, 0)) AS what,
    arg_max(advice, (severity = 'FAIL')::INT * 1000 + coalesce(value_pct, 0)) AS advice
  FROM findings WHERE severity IN ('WARN', 'FAIL') GROUP BY flight_id) USING (flight_id)
ORDER BY list_position(['FAIL', 'WARN', 'GOOD'], verdict), risk_max_pct DESC, elevated_risk_max_pct DESC, log LIMIT 1000;

-- name: no_verdict
-- Why flights that were read have no verdict.
SELECT reason, count(*) AS flights, min(log) AS example FROM flights WHERE status = 'assessed' AND verdict = 'NA'
GROUP BY reason ORDER BY flights DESC, reason LIMIT 20;

-- name: unread
-- Which logs have no answer, by cause.
SELECT status, error, count(*) AS logs, sum(bytes)::BIGINT AS bytes, min(log) AS example FROM flights WHERE status <> 'assessed'
GROUP BY status, error ORDER BY logs DESC, status, error LIMIT 30;
