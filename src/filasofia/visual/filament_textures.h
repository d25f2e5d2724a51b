#pragma once

#include "filasofia/visual/material_store.h"

#include <filament/Engine.h>
#include <filament/MaterialInstance.h>
#include <filament/Texture.h>

#include <map>
#include <string>

namespace filasofia::visual {

/// The textures of materials: each file uploaded once, and the pictures of off-screen views by name.
class TexturePool {
public:
    explicit TexturePool(filament::Engine& engine);
    TexturePool(const TexturePool&) = delete;
    TexturePool& operator=(const TexturePool&) = delete;
    /// All users of the textures must have been destroyed before.
    ~TexturePool();

    /// From now on a view of this name shows `picture`, which another object owns; null: the view is gone.
    void setView(const std::string& name, filament::Texture* picture);

    /// Sets a sampler to the texture; white for none, black for a view that is gone.
    void apply(const Texture& texture, const ReadyMaterial& from, filament::MaterialInstance& instance,
               const char* parameter);
    /// The same for a built-in material, with its parameter "textured" (see texture.glsl).
    void applyWithKind(const Texture& texture, const ReadyMaterial& from, filament::MaterialInstance& instance,
                       const char* parameter);

private:
    filament::Texture* file(const std::string& name, const Image& image);

    filament::Engine& engine_;
    filament::Texture* white_;
    filament::Texture* black_;
    std::map<std::string, filament::Texture*> files_;
    std::map<std::string, filament::Texture*> views_;
};

} // namespace filasofia::visual
