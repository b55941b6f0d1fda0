/* The module inside the script, in base64; the build puts it there. */
let find = () => bytesOf(MODULE);
