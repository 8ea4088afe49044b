"""The node: targets come as messages, and what the motors are to do goes out, piece by piece."""

import rclpy
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PoseStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sinuous import InputError
from sinuous_arm.planner import ArmPlanner, Piece

PARAMETERS = {
    "job": "",  # problem file
    "rate": 50.0,  # points a second
    "seconds": 2.0,  # time for a plan
    "period": 0.1,  # s, after which the next piece goes out
    "horizon": 0.5,  # s, how long a piece is
    "tolerance": 5.0,  # units of the motors, by which measured values may contradict each other
    "velocities": True,  # whether they are sent
}


class ArmNode(Node):
    """Plans to targets and streams `JointTrajectory`; the README has its topics."""

    def __init__(self) -> None:
        super().__init__("arm")
        for name, value in PARAMETERS.items():
            self.declare_parameter(name, value)
        own = {name: self.get_parameter(name).value for name in PARAMETERS}
        self.horizon, self.tolerance, self.with_velocities = own["horizon"], own["tolerance"], own["velocities"]
        self.planner = ArmPlanner(own["job"], self.now, own["rate"], own["seconds"])
        together = ReentrantCallbackGroup()  # pieces go out while a plan is made
        self.publisher = self.create_publisher(JointTrajectory, "~/joint_trajectory", 1)
        self.create_subscription(PoseStamped, "~/target", self.on_target, 1, callback_group=together)
        self.create_subscription(JointState, "~/joint_states", self.on_joint_states, 1)
        self.create_timer(own["period"], self.on_time, callback_group=together)

    def now(self) -> float:
        """Time of the node's clock, s."""
        return self.get_clock().now().nanoseconds * 1e-9

    def on_target(self, message: PoseStamped) -> None:
        """Plan to a target, and begin."""
        place, turn = message.pose.position, message.pose.orientation
        xyzw = (turn.x, turn.y, turn.z, turn.w)
        try:
            motion = self.planner.go((place.x, place.y, place.z), xyzw if any(xyzw) else None)
        except InputError as error:
            self.get_logger().error(str(error))
            return
        (self.get_logger().info if motion.solved else self.get_logger().warning)(str(motion))

    def on_joint_states(self, message: JointState) -> None:
        """Take what the motors measure."""
        try:
            self.planner.measured(dict(zip(message.name, message.position, strict=True)), self.tolerance)
        except InputError as error:
            self.get_logger().error(str(error), throttle_duration_sec=5.0)

    def on_time(self) -> None:
        """Send what comes next."""
        stamp = self.get_clock().now()
        piece = self.planner.piece(self.horizon)
        if piece is not None:
            self.publisher.publish(self.message_of(piece, stamp))

    def message_of(self, piece: Piece, stamp: object) -> JointTrajectory:
        """Return a piece as a message."""
        message = JointTrajectory(joint_names=piece.names)
        message.header.stamp = stamp.to_msg()
        for time, position, velocity in zip(piece.times.tolist(), piece.positions, piece.velocities, strict=True):
            seconds, nanoseconds = divmod(round(time * 1e9), 1_000_000_000)
            message.points.append(
                JointTrajectoryPoint(
                    positions=position.tolist(),
                    velocities=velocity.tolist() if self.with_velocities else [],
                    time_from_start=Duration(sec=seconds, nanosec=nanoseconds),
                )
            )
        return message


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = ArmNode()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
