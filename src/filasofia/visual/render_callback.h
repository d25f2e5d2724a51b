#pragma once

#include "filasofia/visual/gui.h"

#include <memory>
#include <mutex>

namespace filasofia::visual {

/// A RenderCallback that any thread may replace while the main thread calls it.
class GuardedCallback {
public:
    /// Waits for a call that is running, unless it is made inside of it.
    void set(RenderCallback callback)
    {
        auto shared = callback ? std::make_shared<const RenderCallback>(std::move(callback)) : nullptr;
        const std::lock_guard lock(mutex_);
        std::swap(callback_, shared);
    } // the old callback is destroyed here; if it is running, when it ends

    [[nodiscard]] bool empty() const
    {
        const std::lock_guard lock(mutex_);
        return !callback_;
    }

    /// Passes the callback to `invoke`. If that returns false, the callback is not called again, unless it has been
    /// replaced meanwhile.
    template <class Invoke> void call(Invoke&& invoke)
    {
        const std::lock_guard lock(mutex_);
        const std::shared_ptr<const RenderCallback> now = callback_; // keeps it alive if it replaces itself
        if (!now) return;
        if (!invoke(*now) && callback_ == now) callback_ = nullptr;
    }

private:
    mutable std::recursive_mutex mutex_; ///< recursive: a callback may replace itself
    std::shared_ptr<const RenderCallback> callback_;
};

} // namespace filasofia::visual
