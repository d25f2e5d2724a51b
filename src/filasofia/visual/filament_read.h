#pragma once

#include <filament/Engine.h>
#include <filament/RenderTarget.h>
#include <filament/Renderer.h>

#include <cstddef>

namespace filasofia::visual {

/// Pixels in memory that Filament writes, rows from top to bottom.
struct PixelBuffer {
    void* data = nullptr;
    std::size_t bytes = 0;
    filament::backend::PixelDataFormat format = filament::backend::PixelDataFormat::RGBA;
    filament::backend::PixelDataType type = filament::backend::PixelDataType::UBYTE;
};

/// Reads the pixels of `target`, or of the window if it is null, and waits until they are there. `endsFrame` ends the
/// frame of the renderer after the request.
void readPixels(filament::Engine& engine, filament::Renderer& renderer, filament::RenderTarget* target, int width,
                int height, bool endsFrame, const PixelBuffer& out);

} // namespace filasofia::visual
