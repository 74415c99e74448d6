#include <nuno/bullet.h>

#include "thrown.h"

int main() { return throw_with(*nuno::bullet::make_backend(sheet_problem())); }
