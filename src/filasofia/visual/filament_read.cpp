#include "filasofia/visual/filament_read.h"

#include "filasofia/core/assert.h"

#include <backend/PixelBufferDescriptor.h>

namespace filasofia::visual {

void readPixels(filament::Engine& engine, filament::Renderer& renderer, filament::RenderTarget* target, int width,
                int height, bool endsFrame, const PixelBuffer& out)
{
    bool done = false;
    filament::backend::PixelBufferDescriptor pixels(
        out.data, out.bytes, out.format, out.type,
        [](void*, std::size_t, void* user) { *static_cast<bool*>(user) = true; }, &done);
    if (target)
        renderer.readPixels(target, 0, 0, std::uint32_t(width), std::uint32_t(height), std::move(pixels));
    else
        renderer.readPixels(0, 0, std::uint32_t(width), std::uint32_t(height), std::move(pixels));
    if (endsFrame) renderer.endFrame();
    // Filament calls back when it next checks what has finished. That must happen before the memory is gone.
    for (int i = 0; i < 1000 && !done; ++i) engine.flushAndWait();
    FILASOFIA_ASSERT(done);
}

} // namespace filasofia::visual
