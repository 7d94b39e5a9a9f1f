"""See, solve, grasp: episodes of pick and place in a MuJoCo cell, the truth beside what was believed."""
