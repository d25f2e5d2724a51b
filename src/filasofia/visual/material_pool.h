#pragma once

#include "filasofia/visual/filament_textures.h"

#include <filament/Engine.h>
#include <filament/Material.h>
#include <filament/MaterialInstance.h>

#include <map>
#include <string>

namespace filasofia::visual {

/// The compiled materials of this library and the user's own, each loaded when it is first wanted. Filament ends the
/// process on a wrong material or parameter; here each is an Error.
class MaterialPool {
public:
    explicit MaterialPool(filament::Engine& engine) : engine_(engine), textures_(engine) {}
    MaterialPool(const MaterialPool&) = delete;
    MaterialPool& operator=(const MaterialPool&) = delete;
    /// All instances must have been destroyed before.
    ~MaterialPool();

    /// One of the library's own: "tissue", "metal", ...
    filament::Material& get(const std::string& name);
    /// An instance that looks as asked; the caller destroys it.
    filament::MaterialInstance* instance(const ReadyMaterial& material);
    /// Changes an instance of the same name in the pool.
    void apply(const ReadyMaterial& material, filament::MaterialInstance& instance);
    /// The material's name in the pool; two that an instance cannot be changed between have different ones.
    static std::string nameOf(const Material& material);
    [[nodiscard]] TexturePool& textures() { return textures_; }

private:
    /// The textures of a built-in material.
    template <class Held>
    void applyTextures(const Held& held, const ReadyMaterial& from, filament::MaterialInstance& instance);
    filament::Material& get(const CustomMaterial& material, const MaterialPackage& package);
    filament::Material& load(const std::string& name, const std::uint8_t* bytes, std::size_t size);

    filament::Engine& engine_;
    TexturePool textures_;
    std::map<std::string, filament::Material*> loaded_;
};

/// Sets one parameter; throws an Error when the material has none of this name.
template <class Value> void setParameter(filament::MaterialInstance& instance, const char* name, Value value);

} // namespace filasofia::visual
