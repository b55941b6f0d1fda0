/* Runs tests one after another and reports them as TAP. */
const tests = [];

export const test = (name, body) => tests.push({name, body});

/* Returns whether all have passed. */
export const runTests = async () => {
  let failed = 0;
  console.log(`1..${tests.length}`);
  for (const [i, {name, body}] of tests.entries()) {
    try {
      await body();
      console.log(`ok ${i + 1} - ${name}`);
    } catch (error) {
      failed++;
      console.log(`not ok ${i + 1} - ${name}\n${String(error.stack).replace(/^/gm, '# ')}`);
    }
  }
  return failed == 0;
};
