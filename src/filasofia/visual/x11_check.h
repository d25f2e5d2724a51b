#pragma once

namespace filasofia::visual {

/// Throws an Error if there is no X display with OpenGL, or no such window on it: Filament and Xlib would end the
/// process.
void checkX11Window(void* nativeWindow);

} // namespace filasofia::visual
