#pragma once

namespace filasofia {

/// Asks for real-time scheduling of the calling thread, `above` steps above the lowest priority. Not where there is one
/// core: it would starve everything else. False where the system says no: the thread stays an ordinary one.
bool requestRealTime(int above = 0);

} // namespace filasofia
