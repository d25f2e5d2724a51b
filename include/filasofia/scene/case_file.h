#pragma once

#include "filasofia/prefab/trainer.h"

#include <filesystem>

namespace filasofia::scene {

/// Reads a case file of a trainer: a trainer's own case with other settings (docs/guide/hysteroscopy.md). Numbers may
/// have units, as in scenes. For prefab::TrainerDef::readCase. Throws an Error "FILE:LINE:COLUMN: ..." that names the
/// field, its bound and the value.
prefab::TrainerCase loadCase(const std::filesystem::path& file, const prefab::TrainerDef& def);

} // namespace filasofia::scene
