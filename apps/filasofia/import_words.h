#pragma once

#include "apps/filasofia/commands.h"
#include "filasofia/scene/import.h"

#include <string>
#include <vector>

namespace filasofia::app {

/// What a command line says of how a scene or an imported file is read.
struct ImportWords {
    bool anyFolder = false, strict = false;
    std::string package;
    double unit = 1.0;

    /// The first word that is given; null: none is.
    [[nodiscard]] const char* given() const;
    [[nodiscard]] scene::ImportOptions options() const;
};

/// Adds its options to those of a command.
void addOptions(ImportWords& words, std::vector<Option>& to);

} // namespace filasofia::app
