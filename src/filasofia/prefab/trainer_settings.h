#pragma once

#include "filasofia/prefab/trainer.h"

#include <string>

namespace filasofia::prefab {

/// A case file that says what the case is, with every setting that it has and what that means.
std::string caseText(const TrainerDef& def, const TrainerCase& from, int difficulty);

/// The settings of a case of the trainer.
std::vector<TrainerSetting> settingsIn(const TrainerDef& def, int caseIndex);

} // namespace filasofia::prefab
