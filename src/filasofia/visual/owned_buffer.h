#pragma once

#include <backend/BufferDescriptor.h>

#include <vector>

namespace filasofia::visual {

/// A buffer descriptor that owns its data, because the graphics library uploads it later on its own thread.
template <class T> filament::backend::BufferDescriptor ownedBuffer(std::vector<T> data)
{
    auto* kept = new std::vector<T>(std::move(data));
    return {kept->data(), kept->size() * sizeof(T),
            [](void*, std::size_t, void* user) { delete static_cast<std::vector<T>*>(user); }, kept};
}

} // namespace filasofia::visual
