#include <nuno/native.h>

#include "thrown.h"

int main() { return throw_with(*nuno::native::make_backend(chain_problem())); }
