#pragma once

#include "filasofia/prefab/screens.h"

#include <optional>
#include <string>
#include <vector>

/// How a trainee's sessions ended: one line for each in a table for spreadsheets beside the session files.
namespace filasofia::prefab {

struct TrainingRecord {
    std::string date = {}; ///< sorts by time
    std::string trainee = {}, caseName = {}, difficulty = {};
    int seed = 0;
    bool done = false;                ///< the whole task
    double seconds = 0.0;             ///< [s]
    std::optional<double> score = {}; ///< [-], the higher the better
    std::string session = {};         ///< the session's file
};

/// A missing file holds nothing. Lines that are damaged, or not of this table, are left out.
std::vector<TrainingRecord> readResults(const std::string& file);
/// Throws an Error naming the file if it cannot be written.
void appendResult(const std::string& file, const TrainingRecord& record);

/// What counts of a trainee's sessions of a case: the scores or, if there are none, the times of those that were done.
CaseHistory historyOf(const std::vector<TrainingRecord>& all, const std::string& trainee, const std::string& caseName,
                      const std::string& difficulty);

} // namespace filasofia::prefab
