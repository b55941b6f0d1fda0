/* Pictures in the fragment of the page's address, in base64url: "#gscl=" has a bare file, "#gscl-file=" a file with its header. */
const KEYS = {'#gscl=': true, '#gscl-file=': false}; /* whether the file is bare */
const CHARACTERS = 300; /* of a fragment */
export const LINK_BYTES = Math.floor((CHARACTERS - '#gscl='.length) * 3 / 4); /* of a bare file */

export const fits = ({bytes, bare}) => fragmentOf(bytes, bare).length <= CHARACTERS;

export const fragmentOf = (bytes, bare) => {
  const key = Object.keys(KEYS).find(it => KEYS[it] == bare), text = Array.from(bytes, byte => String.fromCharCode(byte)).join('');
  return key + btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=*$/, '');
};

/* {bytes, bare}; undefined where the fragment has another purpose. */
export const readFragment = fragment => {
  const key = Object.keys(KEYS).find(it => fragment.startsWith(it));
  if (!key)
    return undefined;
  try {
    const text = atob(fragment.slice(key.length).replace(/-/g, '+').replace(/_/g, '/'));
    return {bytes: Uint8Array.from(text, character => character.charCodeAt()), bare: KEYS[key]};
  } catch {
    throw Error('it is not base64');
  }
};
