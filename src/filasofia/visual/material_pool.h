#pragma once

#include "filasofia/visual/material.h"

#include <filament/Engine.h>
#include <filament/Material.h>
#include <filament/MaterialInstance.h>

#include <map>
#include <string>

namespace filasofia::visual {

/// The compiled materials of this library, each loaded when it is first wanted. Filament ends the process on a wrong
/// material or parameter; here each is an Error.
class MaterialPool {
public:
    explicit MaterialPool(filament::Engine& engine) : engine_(engine) {}
    MaterialPool(const MaterialPool&) = delete;
    MaterialPool& operator=(const MaterialPool&) = delete;
    /// All instances must have been destroyed before.
    ~MaterialPool();

    /// "tissue" or "metal".
    filament::Material& get(const std::string& name);
    /// An instance that looks as asked; the caller destroys it.
    filament::MaterialInstance* instance(const Material& material);
    /// Changes an instance of the same kind of material.
    static void apply(const Material& material, filament::MaterialInstance& instance);
    /// The material's name in the pool.
    static std::string nameOf(const Material& material);

private:
    filament::Engine& engine_;
    std::map<std::string, filament::Material*> loaded_;
};

/// Sets one parameter; throws an Error when the material has none of this name.
template <class Value> void setParameter(filament::MaterialInstance& instance, const char* name, Value value);

} // namespace filasofia::visual
