#include "filasofia/core/date.h"

#include <ctime>

namespace filasofia {

std::string dateNow()
{
    const std::time_t time = std::time(nullptr);
    std::tm local = {};
    localtime_r(&time, &local);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
    return text;
}

} // namespace filasofia
