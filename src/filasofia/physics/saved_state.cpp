#include "filasofia/physics/saved_state.h"

#include "filasofia/core/error.h"

namespace filasofia::physics {

SavedState::SavedState(std::unique_ptr<const Content> content) : content_(std::move(content)) {}
SavedState::~SavedState() = default;

Command copyOfWaiting(const Command& command)
{
    return std::visit(
        []<class C>(const C& each) -> Command {
            if constexpr (std::is_same_v<C, AddBody> || std::is_same_v<C, RemoveBody> ||
                          std::is_same_v<C, SetMaterial> || std::is_same_v<C, Tune>)
                fail("save: make a step first: the last ", fields(&each).typeName, " has not taken effect");
            else
                return each;
        },
        command);
}

} // namespace filasofia::physics
