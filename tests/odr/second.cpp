#include "everything.hpp"

sizes sizes_in_second() { return {}; }
