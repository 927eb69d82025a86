#include "pictures/picture.hpp"
