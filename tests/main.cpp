#define CATCH_CONFIG_MAIN // the one translation unit that holds Catch2 itself
#include <catch2/catch.hpp>
