/* In place of encoder.js in a build without the encoder. */
export const encode = async () => {
  throw Error('this page was built without the encoder');
};
