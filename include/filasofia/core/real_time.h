#pragma once

namespace filasofia {

/// Asks for real-time scheduling of the calling thread, `above` steps above the lowest priority. Does nothing if the
/// process may use only one core, as it would starve everything else. Returns false if the request was refused or not
/// made: the thread keeps its ordinary scheduling.
bool requestRealTime(int above = 0);

} // namespace filasofia
