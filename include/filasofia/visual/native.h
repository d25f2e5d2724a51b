#pragma once

#include "filasofia/visual/visual_server.h"

namespace filament {
class Engine;
class Renderer;
class Scene;
class View;
} // namespace filament

/// Access to the graphics library (Filament 1.9) behind a server, for what this room does not offer. It is the only
/// such access, and its users depend on that library and its rules. All pointers are null with the null backend.
namespace filasofia::visual::native {

filament::Engine* engine(VisualServer& server);
filament::Renderer* renderer(VisualServer& server);
filament::Scene* scene(VisualServer& server);
filament::View* view(View& view);

} // namespace filasofia::visual::native
