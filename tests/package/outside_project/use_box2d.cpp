#include <nuno/box2d.h>

#include "thrown.h"

int main() { return throw_with(*nuno::box2d::make_backend(chain_problem())); }
