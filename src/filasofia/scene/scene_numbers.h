#pragma once

#include "filasofia/core/error.h"
#include "filasofia/scene/def_shapes.h"

#include <map>

namespace filasofia::scene {

/// Replaces the numbers of bodies and attachments in a Def by their ids.
class SceneNumbers {
public:
    explicit SceneNumbers(const std::vector<BodyId>& ids,
                          const std::map<AttachmentId, AttachmentId>* attachments = nullptr)
        : ids_(ids), attachments_(attachments)
    {
    }

    template <class T> void replaceIn(T& value) const
    {
        if constexpr (std::is_same_v<T, BodyId>) {
            if (value && (value.value > ids_.size() || !ids_[value.value - 1]))
                fail("the scene has ", ids_.size(), " bodies before this one, got body ", value.value);
            if (value) value = ids_[value.value - 1];
        } else if constexpr (std::is_same_v<T, AttachmentId>) {
            if (attachments_) value = attachments_->contains(value) ? attachments_->at(value) : AttachmentId{};
        } else if constexpr (kIsOptional<T>) {
            if (value) replaceIn(*value);
        } else if constexpr (kIsVector<T>) {
            if constexpr (!std::is_arithmetic_v<typename T::value_type>)
                for (auto& each : value) replaceIn(each);
        } else if constexpr (kIsVariant<T>) {
            std::visit([&](auto& held) { replaceIn(held); }, value);
        } else if constexpr (HasFields<T>) {
            forEachField<T>([&](const auto& each) { replaceIn(value.*(each.member)); });
        }
    }

private:
    const std::vector<BodyId>& ids_;
    const std::map<AttachmentId, AttachmentId>* attachments_;
};

} // namespace filasofia::scene
