#pragma once

#include "filasofia/visual/visual_server.h"

#include <string>

namespace filasofia::runtime {

/// Tells that a camera shows no body, because none is between its near and far: the picture is then black. On the
/// thread that draws.
class UnseenBodies {
public:
    /// Another look at the scene comes: what is wrong with it is told, too, unless it is the same.
    void lookAgain() { looked_ = false; }
    /// Looks for bodies ahead of the cameras of all visible views, unless it has.
    void look(const visual::VisualServer& server);

private:
    bool looked_ = false;
    std::string told_; ///< the last line
};

} // namespace filasofia::runtime
