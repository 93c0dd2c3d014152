#include <stub.hpp>
