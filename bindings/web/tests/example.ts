// Code as users write it, with the types of the package; package.test.mjs compiles it.

import { Flight, Panic, Profile, RuleSet, RuleText, start, type Diagnostic, type Moment, type Value } from 'flagred';

export async function tip(text: string): Promise<number | null> {
  await start();
  const rules = new RuleSet(text);
  try {
    const [value]: Value[] = rules.evaluate([8, null]);
    const tip: number = rules.value({ service: 8, food: 9 }, 'tip');
    return value?.value ?? tip;
  } finally {
    rules.free();
  }
}

export function wrong(text: string): string[] {
  const open = new RuleText(text);
  const findings: Diagnostic[] = open.findings();
  open.free();
  return findings.map(({ line, severity, message, help }) => `${line}: ${severity}: ${message}${help ? ` (${help})` : ''}`);
}

export function risky(name: string, log: Uint8Array): { verdict: string; risk: number | null } {
  try {
    const assessed = Flight.fromBytes(name, log).assess(Profile.named('flagred'));
    const { verdict, summary } = assessed.brief();
    const moment: Moment = assessed.moment(summary.risk_max?.t_s ?? 0);
    return { verdict, risk: moment.step?.risk ?? null };
  } catch (error) {
    if (error instanceof Panic) throw new Error(`flagred has a defect: ${error.message}`);
    throw error;
  }
}
