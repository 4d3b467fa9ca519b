// The window of a page of its own: its token, and what is kept over a reload.
import { Studio } from "./studio.js";
import { SocketWire } from "./wire.js";

const KEPT = "compoundkin-studio";
const before = (() => { try { return JSON.parse(sessionStorage.getItem(KEPT)); } catch { return null; } })();
const token = location.hash.slice(1) || before?.token || "";
// the token leaves the address, which people copy
history.replaceState(null, "", location.pathname);
const keep = (state) => { try { sessionStorage.setItem(KEPT, JSON.stringify(state)); } catch { /* too long to be kept */ } };

window.studio = new Studio(document.getElementById("window"), {
  alone: true,
  kept: { token, before: before?.token === token ? before : null, keep },
  wire: (told) => new SocketWire(token, told),
});
