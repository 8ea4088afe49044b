"""When a robot is where on its way: as fast as rates and accelerations allow."""
