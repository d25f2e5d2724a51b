#pragma once

#include "filasofia/visual/visual_server.h"

#include <set>
#include <string>

namespace filasofia::runtime {

/// Tells once for each camera and lens that it shows no body, because none is between its near and far: the picture is
/// then black. On the thread that draws.
class UnseenBodies {
public:
    /// Another look at the scene comes.
    void lookAgain() { looked_ = false; }
    /// A camera is not yet where it will be: look() does nothing until lookAgain().
    void wait() { looked_ = true; }
    /// Looks for bodies ahead of the cameras of all visible views, unless it has.
    void look(const visual::VisualServer& server);

private:
    bool looked_ = false;
    std::set<std::string> told_; ///< cameras with their near and far
};

} // namespace filasofia::runtime
