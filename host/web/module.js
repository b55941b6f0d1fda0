/* The module of an ordinary page: a file beside the script, named in the form by which bundlers take it along. */
let locate = () => new URL('gscl.wasm', import.meta.url);
export const useFile = it => (locate = it, found = 0);
let find = async () => (await fetchFile(locate(), 'failed')).arrayBuffer();
