// Which of several waits for the server still matters: where one chooses again before the answer is there, the last
// choice holds.

/** @returns {() => () => boolean} begins something, and returns what says whether nothing else was begun since */
export function latest() {
  let begun = 0;
  return () => {
    const mine = ++begun;
    return () => mine === begun;
  };
}
